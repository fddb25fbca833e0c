// Meshes through files of every format and back.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <tufa/io.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include "support/expect_error.h"
#include "support/scratch_folder.h"

namespace tufa {
namespace {

using test::expectError;
using test::readBytes;
using test::ScratchFolder;
using test::writeBytes;

/// A pyramid: one quad below, four triangles above; shifted, so that precision can be tested.
Mesh makePyramid(double shift = 0) {
  Mesh mesh;
  for (const auto& [x, y, z] :
       {std::array{0.1, 0.0, 0.0}, {0.1, 1.0, 0.0}, {1.1, 1.0, 0.0}, {1.1, 0.0, 0.0}}) {
    mesh.positions.emplace_back(x + shift, y, z);
  }
  mesh.positions.emplace_back(0.6 + shift, 0.5, 1.0);
  for (const Position& p : mesh.positions) {
    const double length = std::hypot(p.x - 0.6 - shift, p.y - 0.5, p.z - 0.3);
    mesh.normals.emplace_back(static_cast<float>((p.x - 0.6 - shift) / length),
                              static_cast<float>((p.y - 0.5) / length),
                              static_cast<float>((p.z - 0.3) / length));
  }
  mesh.quads.emplace_back(0, 1, 2, 3);
  mesh.triangles = {{1, 0, 4}, {2, 1, 4}, {3, 2, 4}, {0, 3, 4}};
  return mesh;
}

double volumeOf(const Mesh& mesh) {
  double sixfold = 0;
  for (const Triangle& t : triangulate(mesh)) {
    const Position& a = mesh.positions.at(t.vertices[0]);
    const Position& b = mesh.positions.at(t.vertices[1]);
    const Position& c = mesh.positions.at(t.vertices[2]);
    sixfold += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
               a.z * (b.x * c.y - b.y * c.x);
  }
  return sixfold / 6;
}

TEST(WriteFile, TakesWhatIsPutIntoAStream) {
  const ScratchFolder folder;
  const std::string text(100000, 'x');
  writeFile([&](std::ostream& stream) { stream << text << 7; }, folder / "t.txt");
  EXPECT_EQ(readBytes(folder / "t.txt"), text + "7");
}

TEST(WriteFile, MakesNoFileOfAStreamThatHasFailed) {
  const ScratchFolder folder;
  const auto putAfterASeek = [](std::ostream& stream) {
    stream << "head";
    stream.seekp(0, std::ios::end);
    stream << "tail";
  };
  expectError(ErrorCode::UnwritableFile, "something failed on the stream",
              [&] { writeFile(putAfterASeek, folder / "t.txt"); });
  EXPECT_EQ(folder.fileCount(), 0);
}

TEST(WriteFile, LeavesTheFileThatWasThereWhereTheWriterThrows) {
  const ScratchFolder folder;
  writeFile("before", folder / "t.txt");
  const auto fail = [](std::ostream& stream) {
    stream << std::string(1 << 20, 'x');
    throw Error(ErrorCode::Cancelled, "cancelled");
  };
  expectError(ErrorCode::Cancelled, "cancelled", [&] { writeFile(fail, folder / "t.txt"); });
  EXPECT_EQ(readBytes(folder / "t.txt"), "before");
  EXPECT_EQ(folder.fileCount(), 1);
}

class EveryFormat : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat,
                         ::testing::Values(".ply", ".obj", ".stl", ".off", ".glb", ".PLY", ".Stl"),
                         [](const auto& test) {
                           return std::string(test.param + 1) + std::to_string(test.index);
                         });

TEST_P(EveryFormat, KeepsTheSurface) {
  const ScratchFolder folder;
  const Mesh mesh = makePyramid();
  write(mesh, folder / (std::string("pyramid") + GetParam()));
  const Mesh back = readMesh(folder / (std::string("pyramid") + GetParam()));
  EXPECT_EQ(back.positions.size(), 5u);
  EXPECT_EQ(back.triangleCount(), 6u);
  EXPECT_NEAR(volumeOf(back), volumeOf(mesh), 1e-6);
  EXPECT_EQ(folder.fileCount(), 1);
}

TEST_P(EveryFormat, TakesAnEmptyMesh) {
  const ScratchFolder folder;
  const auto path = folder / (std::string("empty") + GetParam());
  write({}, path);
  EXPECT_GT(std::filesystem::file_size(path), 0u);
}

/// Whatever is cut off or changed, the reader answers with a mesh of valid indices or an Error.
TEST_P(EveryFormat, SurvivesDamage) {
  const ScratchFolder folder;
  const auto path = folder / (std::string("damaged") + GetParam());
  write(makePyramid(), path);
  const std::string whole = readBytes(path);
  const auto tryToRead = [&](const std::string& bytes) {
    writeBytes(path, bytes);
    try {
      const Mesh mesh = readMesh(path);
      for (const Triangle& t : triangulate(mesh)) {
        for (const VertexIndex v : t.vertices) ASSERT_LT(v, mesh.positions.size());
      }
      for (const Position& p : mesh.positions) {
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      }
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), ErrorCode::UnreadableFile) << error.what();
    }
  };
  for (std::size_t length = 0; length < whole.size(); ++length) tryToRead(whole.substr(0, length));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int flip : {0x01, 0x80}) {
      std::string changed = whole;
      changed[at] = static_cast<char>(changed[at] ^ flip);
      tryToRead(changed);
    }
  }
}

TEST_P(EveryFormat, LeavesNothingWhenCancelled) {
  const ScratchFolder folder;
  WriteOptions options;
  options.progress = [](std::string_view, double) { return false; };
  expectError(ErrorCode::Cancelled, "cancelled", [&] {
    write(makePyramid(), folder / (std::string("cancelled") + GetParam()), options);
  });
  EXPECT_EQ(folder.fileCount(), 0);
}

/// A flat square of quads, with normals where asked for.
Mesh makeSquare(unsigned side, bool normals) {
  Mesh mesh;
  for (unsigned x = 0; x < side; ++x) {
    for (unsigned y = 0; y < side; ++y) {
      mesh.positions.emplace_back(x, y, 0);
      if (normals) mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
      if (x == 0 || y == 0) continue;
      const VertexIndex here = x * side + y;
      mesh.quads.emplace_back(here - side - 1, here - 1, here, here - side);
    }
  }
  return mesh;
}

// It ended at 0.4 for .usda, at half for .stl and at three quarters for .ply.
TEST(MeshFiles, ProgressRisesTo1) {
  const ScratchFolder folder;
  for (const std::string_view name : meshFormatNames()) {
    const std::filesystem::path path = folder / std::string("m.").append(name);
    if (!hasFormat(meshFormatOf(path))) continue;
    for (const bool normals : {false, true}) {
      std::vector<double> fractions;
      WriteOptions options;
      options.progress = [&](std::string_view, double fraction) {
        fractions.push_back(fraction);
        return true;
      };
      write(makeSquare(400, normals), path, options);
      EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end())) << name;
      ASSERT_GE(fractions.size(), 2u) << name;
      EXPECT_EQ(fractions.back(), 1) << name;
      EXPECT_GT(fractions[fractions.size() - 2], 0.9) << name << normals;
    }
  }
}

TEST(MeshFiles, KeepQuadsWhereTheFormatHasThem) {
  const ScratchFolder folder;
  for (const char* name : {"m.ply", "m.obj", "m.off"}) {
    write(makePyramid(), folder / name);
    EXPECT_EQ(readMesh(folder / name).quads, makePyramid().quads) << name;
    EXPECT_EQ(readMesh(folder / name).triangles, makePyramid().triangles) << name;
  }
}

TEST(MeshFiles, PlyKeepsNormals) {
  const ScratchFolder folder;
  write(makePyramid(), folder / "m.ply");
  EXPECT_EQ(readMesh(folder / "m.ply").normals, makePyramid().normals);
}

// A line that ends in a backslash goes on in the next one.
TEST(MeshFiles, ObjNamesMayEndInABackslash) {
  const ScratchFolder folder;
  WriteOptions options;
  options.name = "part\\";
  write(makePyramid(), folder / "m.obj", options);
  EXPECT_EQ(readMesh(folder / "m.obj").positions.size(), 5U);
}

TEST(MeshFiles, AttributesHaveNamesOfTheirOwn) {
  const ScratchFolder folder;
  Mesh mesh = makePyramid();
  const auto add = [&](const char* name, int width, AttributeRole role) {
    Attribute attribute;
    attribute.name = name, attribute.width = width, attribute.role = role;
    attribute.values.assign(5 * static_cast<std::size_t>(width), 0.5F);
    mesh.attributes.push_back(attribute);
  };
  add("a", 1, AttributeRole::Value), add("A", 1, AttributeRole::Value);
  add("a_2", 1, AttributeRole::Value), add("a.2", 1, AttributeRole::Value);
  add("v", 3, AttributeRole::Value), add("v_x", 1, AttributeRole::Value);
  add("Cd", 3, AttributeRole::Colour), add("Ci", 3, AttributeRole::Colour);
  write(mesh, folder / "m.ply");
  const std::string ply = readBytes(folder / "m.ply");
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  };
  for (const char* name : {"a", "A", "a_2", "a_2_2", "v_x", "v_x_2", "v_y", "red", "Ci_r"}) {
    EXPECT_EQ(count(ply, std::string(" ") + name + "\n"), 1U) << name;
  }
  write(mesh, folder / "m.glb");
  const std::string glb = readBytes(folder / "m.glb");
  for (const char* name : {"_A", "_A_2", "_A_2_2", "_A_2_3", "_V", "_V_X", "COLOR_0", "COLOR_1"}) {
    EXPECT_EQ(count(glb, "\"" + std::string(name) + "\":"), 1U) << name;
  }
  mesh.attributes[0].values[2] = std::nanf("");
  expectError(ErrorCode::InvalidArgument, "not finite", [&] { write(mesh, folder / "m.ply"); });
  mesh.attributes[0].name.clear();
  expectError(ErrorCode::InvalidArgument, "no name", [&] { write(mesh, folder / "m.ply"); });
}

TEST(MeshFiles, KeepDoublePrecisionFarFromTheOrigin) {
  const ScratchFolder folder;
  const Mesh mesh = makePyramid(1e6);
  for (const char* name : {"m.ply", "m.obj", "m.off"}) {
    write(mesh, folder / name);
    EXPECT_EQ(readMesh(folder / name).positions, mesh.positions) << name;
  }
  write(mesh, folder / "m.glb");  // relative to the node's translation
  const Mesh glb = readMesh(folder / "m.glb");
  for (std::size_t n = 0; n < mesh.positions.size(); ++n) {
    EXPECT_NEAR(glb.positions.at(n).x, mesh.positions[n].x, 1e-6);
  }
}

TEST(MeshFiles, StlIsRefusedWhereSinglePrecisionMovesFaces) {
  const ScratchFolder folder;
  write(makePyramid(1e3), folder / "m.stl");
  expectError(ErrorCode::LimitExceeded, "single precision",
              [&] { write(makePyramid(1e8), folder / "far.stl"); });
  EXPECT_EQ(folder.fileCount(), 1);
}

// Two pyramids far apart: floats hold neither, from wherever they are counted.
TEST(MeshFiles, FormatsOfFloatsAreRefusedWhereTheyMoveVerticesFar) {
  const ScratchFolder folder;
  const auto apart = [](double way) {
    Mesh mesh = makePyramid();
    const Mesh other = makePyramid(way);
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    mesh.normals.clear();
    for (VertexIndex v = 1; v < 5; ++v) mesh.triangles.emplace_back(5 + v, 5, 5 + v % 4 + 1);
    return mesh;
  };
  for (const char* name : {"m.glb", "m.usda", "m.stl"}) {
    WriteReport report;
    write(apart(1e4), folder / name, {}, &report);
    EXPECT_GT(report.rounding, 1e-6) << name;
    EXPECT_LT(report.rounding, 1e-3) << name;
    expectError(ErrorCode::LimitExceeded, "single precision",
                [&] { write(apart(3e7), folder / name); });
  }
  WriteReport report;
  write(apart(3e7), folder / "m.ply", {}, &report);
  EXPECT_EQ(report.rounding, 0);
}

// .glb had null for the bounds of its positions, .usda inf.
TEST(MeshFiles, RefusePositionsThatNoFloatIsNear) {
  const ScratchFolder folder;
  for (const double size : {1e39, 1e308}) {
    Mesh mesh = makePyramid();
    for (Position& p : mesh.positions) p = {p.x * size, p.y * size, p.z * size};
    for (const char* name : {"m.glb", "m.usda", "m.stl"}) {
      expectError(ErrorCode::LimitExceeded, "single precision",
                  [&] { write(mesh, folder / name); });
    }
    EXPECT_EQ(folder.fileCount(), 0);
    for (const char* name : {"m.ply", "m.obj", "m.off"}) {
      write(mesh, folder / name);
      EXPECT_EQ(readMesh(folder / name).positions, mesh.positions) << name;
      std::filesystem::remove(folder / name);
    }
  }
}

TEST(MeshFiles, AreReadFromFormatsThatAreRead) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "d.ply");
  expectError(ErrorCode::UnreadableFile, "a folder", [&] { (void)readMesh(folder / "d.ply"); });
  expectError(ErrorCode::InvalidArgument, ".off and .glb",
              [&] { (void)readMesh(folder / "volume.vdb"); });
  for (const char* name : {"e.ply", "e.obj", "e.stl", "e.off", "e.glb"}) {
    write({}, folder / name);
    EXPECT_TRUE(readMesh(folder / name).positions.empty()) << name;
  }
}

TEST(MeshFiles, RefuseUnknownEndings) {
  const ScratchFolder folder;
  for (const char* name : {"m.txt", "m", "ply"}) {
    expectError(ErrorCode::InvalidArgument, ".ply", [&] { write({}, folder / name); });
    expectError(ErrorCode::InvalidArgument, ".ply", [&] { (void)readMesh(folder / name); });
    expectError(ErrorCode::InvalidArgument, ".ply", [&] { requireMeshEnding(folder / name); });
  }
}

TEST(MeshFiles, RefuseUnusableTargets) {
  const ScratchFolder folder;
  const Mesh mesh = makePyramid();
  expectError(ErrorCode::UnwritableFile, "no folder", [&] { write(mesh, folder / "no/m.ply"); });
  std::filesystem::create_directory(folder / "d.ply");
  expectError(ErrorCode::UnwritableFile, "folder", [&] { write(mesh, folder / "d.ply"); });
}

TEST(MeshFiles, TellOfAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  expectError(ErrorCode::UnwritableFile, "space", [] { write(makePyramid(), "/dev/full"); });
}

TEST(MeshFiles, WriteToDevices) {
  write(makePyramid(), "/dev/null");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(MeshFiles, KeepTheOldFileWhenWritingFails) {
  const ScratchFolder folder;
  writeBytes(folder / "m.stl", "old");
  Mesh mesh = makePyramid();
  mesh.triangles.emplace_back(0, 1, 99);  // .stl looks its corners up
  EXPECT_ANY_THROW(write(mesh, folder / "m.stl"));
  EXPECT_EQ(readBytes(folder / "m.stl"), "old");
  EXPECT_EQ(folder.fileCount(), 1);
}

TEST(MeshFiles, FollowSymbolicLinks) {
  const ScratchFolder folder;
  writeBytes(folder / "target.ply", "old");
  std::filesystem::create_symlink("target.ply", folder / "link.ply");
  write(makePyramid(), folder / "link.ply");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.ply"));
  EXPECT_EQ(readMesh(folder / "target.ply").triangleCount(), 6u);
}

TEST(MeshFiles, RefuseWhatIsNoFile) {
  const ScratchFolder folder;
  expectError(ErrorCode::UnreadableFile, "No such", [&] { (void)readMesh(folder / "no.ply"); });
  std::filesystem::create_directory(folder / "d.obj");
  expectError(ErrorCode::UnreadableFile, "folder", [&] { (void)readMesh(folder / "d.obj"); });
  ASSERT_EQ(::mkfifo((folder / "pipe.off").c_str(), 0600), 0);
  expectError(ErrorCode::UnreadableFile, "regular", [&] { (void)readMesh(folder / "pipe.off"); });
  writeBytes(folder / "empty.glb", "");
  expectError(ErrorCode::UnreadableFile, "empty", [&] { (void)readMesh(folder / "empty.glb"); });
}

}  // namespace
}  // namespace tufa
