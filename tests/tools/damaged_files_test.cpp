// Damaged files of every kind, made the same way each time: the command refuses each within five
// seconds and a gibibyte of addresses, with one line and exit code 3, and never crashes.

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "tools/command_fixture.h"
#include "tools/limited_run.h"

namespace tufa {
namespace {

using test::kSanitized;
using test::readBytes;
using test::ScratchFolder;
using test::writeBytes;

class DamagedFiles : public ::testing::Test {
 protected:
  using Outcome = test::LimitedOutcome;

  Outcome run(const std::vector<std::string>& words) {
    return test::runLimited(words, folder / "errors");
  }

  std::vector<std::string> commandFor(const std::string& file) {
    if (file.ends_with(".vdb")) {
      return {"tufa",  "mesh", folder / file, "-o",        folder / "m.ply",
              "--iso", "auto", "--quiet",     "--threads", "1"};
    }
    return {"tufa", "check", folder / file, "--quiet", "--threads", "1"};
  }

  /// A file that cannot be used: exit code 3, and one line that names it.
  void expectRefusal(const std::string& file, const std::string& what) {
    expectRefusal(file, what, commandFor(file));
  }
  void expectRefusal(const std::string& file, const std::string& what,
                     const std::vector<std::string>& command) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exitCode, 3) << file << ", " << what << ": " << outcome.err;
    EXPECT_EQ(outcome.err.rfind("tufa: ", 0), 0u) << what << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(file), std::string::npos) << what << ": " << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1)
        << what << ": " << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "m.ply")) << what;
    ++refusals;
  }

  void refuse(const std::string& file, const std::string& bytes, const std::string& what) {
    writeBytes(folder / file, bytes);
    expectRefusal(file, what);
  }

  /// A file that may be sound in spite of all: any exit code, but no signal and no hang.
  void survive(const std::string& file, const std::string& bytes, const std::string& what) {
    writeBytes(folder / file, bytes);
    const Outcome outcome = run(commandFor(file));
    EXPECT_TRUE(outcome.exitCode == 0 || outcome.exitCode == 1 || outcome.exitCode == 3)
        << file << ", " << what << ": " << outcome.exitCode << " " << outcome.err;
    std::filesystem::remove(folder / "m.ply");
  }

  /// A sound file of a shape, as a volume.
  std::string soundVolume(const std::string& shape, const std::string& voxel) {
    const std::string file = folder / "sound.vdb";
    EXPECT_EQ(run({"tufa", "make", shape, "--voxel", voxel, "-o", file}).exitCode, 0);
    return readBytes(file);
  }

  /// A sound mesh file of that ending.
  std::string soundMesh(const std::string& ending) {
    soundVolume("sphere", "0.2");
    const std::string file = folder / ("sound." + ending);
    EXPECT_EQ(
        run({"tufa", "mesh", folder / "sound.vdb", "--uniform", "--quiet", "-o", file}).exitCode,
        0);
    return readBytes(file);
  }

  const ScratchFolder folder;
  int refusals = 0;
};

template <class T>
std::string with(std::string bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

TEST_F(DamagedFiles, VolumesCutShort) {
  const std::string whole = soundVolume("sphere", "0.15");
  for (std::size_t length = 0; length < whole.size(); length += 1024) {
    refuse("f.vdb", whole.substr(0, length), std::to_string(length) + " bytes");
  }
  for (std::size_t length = 1; length < 700; length += 41) {
    refuse("f.vdb", whole.substr(0, length), std::to_string(length) + " bytes");
  }
  EXPECT_GE(refusals, 60);
}

/// Places in the head of a file whose meaning is known: magic number, version, counts, lengths.
TEST_F(DamagedFiles, VolumesWithAFalseHead) {
  const std::string whole = soundVolume("sphere", "0.2");
  for (std::size_t byte = 0; byte < 8; ++byte) {
    std::string bytes = whole;
    bytes[byte] = static_cast<char>(bytes[byte] ^ 0x10);
    refuse("f.vdb", bytes, "magic byte " + std::to_string(byte));
  }
  // Behind magic number, three versions, the flag of offsets and the id of 36 characters.
  constexpr std::size_t kMetadata = 8 + 3 * 4 + 1 + 36;
  for (const std::uint32_t count : {0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu, 0x10000u}) {
    refuse("f.vdb", with(whole, kMetadata, count), "count of metadata " + std::to_string(count));
  }
  std::uint32_t entries = 0;
  std::memcpy(&entries, whole.data() + kMetadata, sizeof entries);
  std::size_t place = kMetadata + 4;
  const auto length = [&] {
    std::uint32_t n = 0;
    std::memcpy(&n, whole.data() + place, sizeof n);
    return n;
  };
  const auto refuseLengths = [&](const std::string& what) {
    for (const std::uint32_t n : {0xFFFFFFFFu, 0x80000000u, 0x3FFFFFFFu, 0x01000000u}) {
      refuse("f.vdb", with(whole, place, n), what + " " + std::to_string(n));
    }
    place += 4 + length();
  };
  for (std::uint32_t n = 0; n < entries; ++n) {
    refuseLengths("length of a name");
    refuseLengths("length of a type");
    refuseLengths("length of a value");
  }
  for (const std::int32_t count : {0x7FFFFFFF, 1000}) {
    refuse("f.vdb", with(whole, place, count), "grids " + std::to_string(count));
  }
  place += 4;
  refuseLengths("length of the grid's name");
  refuseLengths("length of the grid's type");
  refuseLengths("length of the parent's name");
  // Of the three offsets the second, to blocks of values, is not used.
  for (const std::size_t offset : {0, 16}) {
    for (const std::int64_t position : {std::int64_t{-1}, std::int64_t{1} << 40}) {
      refuse("f.vdb", with(whole, place + offset, position), "offset " + std::to_string(position));
    }
  }
  EXPECT_GE(refusals, 30);
}

TEST_F(DamagedFiles, VolumesWithFlippedBits) {
  std::mt19937 random(1);  // the same sequence everywhere
  for (const char* shape : {"sphere", "fog"}) {
    const std::string whole = soundVolume(shape, "0.2");
    for (int n = 0; n < 60; ++n) {
      std::string bytes = whole;
      // Half of them in the first kilobytes: the head, the transform, the upper nodes.
      const std::size_t reach =
          n % 2 == 0 ? std::min<std::size_t>(2000, bytes.size()) : bytes.size();
      for (int flips = 0; flips < 1 + n % 3; ++flips) {
        bytes[random() % reach] ^= static_cast<char>(1u << random() % 8);
      }
      survive("f.vdb", bytes, "flips " + std::to_string(n));
    }
  }
}

/// OpenVDB reads as many bytes as a block of values says it has, wherever its buffer ends. That
/// overwrites the heap, where the crash may come at once or in the C library.
TEST_F(DamagedFiles, VolumesThatCrashTheirReaderInEverySubcommand) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer ends the program before the guard does";
  const std::string whole = soundVolume("fog", "0.1");
  soundMesh("ply");
  const std::vector<std::vector<std::string>> commands = {
      {"tufa", "mesh", folder / "f.vdb", "-o", folder / "m.ply"},
      {"tufa", "lod", folder / "f.vdb", "-o", folder / "m.glb"},
      {"tufa", "chunks", folder / "f.vdb", "-o", folder / "chunks"},
      {"tufa", "check", folder / "sound.ply", "--against", folder / "f.vdb"},
      {"tufa", "info", folder / "f.vdb"}};
  std::size_t blocks = 0;
  for (std::size_t place = 0; place + 24 < whole.size(); ++place) {
    // A compressed block: its size in 8 bytes, then Blosc's header of 16, which begins with a
    // version and ends with the same size.
    std::uint64_t size = 0;
    std::uint32_t again = 0;
    std::memcpy(&size, whole.data() + place, sizeof size);
    std::memcpy(&again, whole.data() + place + 20, sizeof again);
    if (size != again || size < 16 || size > whole.size() || whole[place + 8] != 2) continue;
    const auto rest = static_cast<std::int64_t>(whole.size() - place - 8);
    writeBytes(folder / "f.vdb", with(whole, place, -rest));
    const std::string what = "negative size at byte " + std::to_string(place);
    expectRefusal("f.vdb", what, commands[blocks++ % commands.size()]);
  }
  if (blocks == 0) GTEST_SKIP() << "this OpenVDB does not compress with Blosc";
  EXPECT_GE(blocks, commands.size());
}

TEST_F(DamagedFiles, MeshesCutShort) {
  for (const char* ending : {"ply", "stl", "off", "glb"}) {
    const std::string whole = soundMesh(ending);
    const std::size_t steps = 16;
    for (std::size_t n = 0; n < steps; ++n) {
      refuse(std::string("f.") + ending, whole.substr(0, whole.size() * n / steps),
             std::to_string(n) + " sixteenths");
    }
  }
  EXPECT_GE(refusals, 60);
}

TEST_F(DamagedFiles, MeshesWithFlippedBits) {
  std::mt19937 random(2);
  for (const char* ending : {"ply", "obj", "stl", "off", "glb"}) {
    const std::string whole = soundMesh(ending);
    for (int n = 0; n < 20; ++n) {
      std::string bytes = whole;
      const std::size_t reach =
          n % 2 == 0 ? std::min<std::size_t>(300, bytes.size()) : bytes.size();
      for (int flips = 0; flips < 1 + n % 3; ++flips) {
        bytes[random() % reach] ^= static_cast<char>(1u << random() % 8);
      }
      survive(std::string("f.") + ending, bytes, "flips " + std::to_string(n));
    }
  }
}

TEST_F(DamagedFiles, MeshesThatLie) {
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
  const auto ply = [](const std::string& format, const std::string& vertices,
                      const std::string& faces) {
    return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  };
  for (const char* count : {"1000000000", "4294967296", "18446744073709551615", "-1", "x", ""}) {
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      refuse("f.ply", ply(format, "3", count) + corners + "3 0 1 2\n", count);
      refuse("f.ply", ply(format, count, "1") + corners + "3 0 1 2\n", count);
    }
    if (std::string(count).empty()) continue;  // the next number takes its place
    refuse("f.off", std::string("OFF\n3 ") + count + " 0\n" + corners + "3 0 1 2\n", count);
    refuse("f.off", std::string("OFF\n") + count + " 1 0\n" + corners + "3 0 1 2\n", count);
  }
  for (const char* index : {"3", "-1", "4294967296", "1e9", "nan"}) {
    const std::string face = std::string("3 0 1 ") + index + "\n";
    refuse("f.ply", ply("ascii", "3", "1") + corners + face, index);
    refuse("f.off", "OFF\n3 1 0\n" + corners + face, index);
  }
  for (const char* index : {"0", "4", "-4", "4294967297", "1e9", "nan"}) {
    refuse("f.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 ") + index + "\n", index);
  }
  for (const char* number : {"nan", "-nan", "inf", "1e999", "x", ""}) {
    const std::string corner = std::string("0 0 ") + number + "\n1 0 0\n0 1 0\n";
    if (!std::string(number).empty()) {  // else the next number takes its place
      refuse("f.ply", ply("ascii", "3", "1") + corner + "3 0 1 2\n", number);
    }
    refuse("f.off", "OFF\n3 1 0\n" + corner + "3 0 1 2\n", number);
    refuse("f.obj", std::string("v 0 0 ") + number + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", number);
  }
  const std::string stl = soundMesh("stl");
  for (const std::uint32_t count : {0xFFFFFFFFu, 1000000000u, 0x80000000u}) {
    refuse("f.stl", with(stl, 80, count), std::to_string(count) + " triangles");
  }
  for (const std::uint32_t nan : {0x7FC00000u, 0x7F800000u, 0xFF800000u}) {
    refuse("f.stl", with(stl, 96, nan), "corner that is not finite");
  }
  EXPECT_GE(refusals, 80);
}

TEST_F(DamagedFiles, ContainersThatLie) {
  const std::string glb = soundMesh("glb");
  for (const std::size_t place : {0, 4, 8, 12, 16}) {
    for (const std::uint32_t value : {0xFFFFFFFFu, 0x7FFFFFFFu, 0x10000000u, 3u}) {
      refuse("f.glb", with(glb, place, value), "word at " + std::to_string(place));
    }
  }
  EXPECT_GE(refusals, 20);
}

TEST_F(DamagedFiles, NotFilesAtAll) {
  for (const char* ending : {"vdb", "ply", "obj", "stl", "off", "glb"}) {
    const std::string end = std::string(".") + ending;
    refuse("empty" + end, "", "empty");
    // As an .stl file, no triangles and some bytes behind them.
    if (end != ".stl") refuse("zeros" + end, std::string(4096, '\0'), "zeros");
    expectRefusal("none" + end, "missing");
    std::filesystem::create_directory(folder / ("folder" + end));
    expectRefusal("folder" + end, "folder");
    ASSERT_EQ(::mkfifo((folder / ("pipe" + end)).c_str(), 0600), 0);
    expectRefusal("pipe" + end, "pipe without a writer");
    std::filesystem::create_symlink("loop" + end, folder / ("loop" + end));
    expectRefusal("loop" + end, "link to itself");
    if (std::filesystem::exists("/dev/zero")) {
      std::filesystem::create_symlink("/dev/zero", folder / ("device" + end));
      expectRefusal("device" + end, "device");
    }
  }
  EXPECT_GE(refusals, 36);
}

}  // namespace
}  // namespace tufa
