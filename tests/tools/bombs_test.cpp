// Volumes whose buffers unpack to far more than the file: the memory that the command takes stays
// in the proportion to the file that docs/limits.md states, or the file is refused.

#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/StreamCompression.h>
#include <zlib.h>

#include <tufa/io.h>
#include <tufa/mesh.h>
#include <cstdint>
#include <cstring>
#include <random>

#include "tools/limited_run.h"

namespace tufa {
namespace {

using namespace openvdb::io;
using test::kSanitized;
using test::readBytes;
using test::writeBytes;

constexpr std::uint64_t kMegabyte = std::uint64_t{1} << 20;
/// What the command takes for itself, and for a file of no size.
constexpr std::uint64_t kLeastBytes = 64 * kMegabyte;

class Bombs : public ::testing::Test {
 protected:
  Bombs() { openvdb::initialize(); }

  test::LimitedOutcome run(const std::vector<std::string>& words) {
    std::vector<std::string> all{"tufa"};
    all.insert(all.end(), words.begin(), words.end());
    return test::runLimited(all, folder / "errors", {rlim_t{4} << 30, 120});
  }

  void write(const openvdb::GridBase::Ptr& grid, std::uint32_t compression) {
    openvdb::io::File out(file);
    out.setCompression(compression);
    out.write({grid});
  }

  /// Writes a grid that takes at least `factor` times the memory of its file.
  void expectBomb(const openvdb::GridBase::Ptr& grid, std::uint32_t compression,
                  std::uint64_t factor) {
    write(grid, compression);
    EXPECT_GT(grid->memUsage(), factor * std::filesystem::file_size(file));
  }

  /// The command's memory is within `factor` times the file.
  void expectProportion(const std::vector<std::string>& words, std::uint64_t factor) {
    const auto outcome = run(words);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    if (kSanitized) return;
    EXPECT_LT(outcome.peakBytes, kLeastBytes + factor * std::filesystem::file_size(file))
        << words[0] << " of " << std::filesystem::file_size(file) << " bytes";
  }

  void expectRefusal(const std::string& bytes, const std::string& part) {
    writeBytes(file, bytes);
    for (const auto& words : {std::vector<std::string>{"info", file},
                              std::vector<std::string>{"mesh", file, "-o", folder / "m.ply"}}) {
      const auto outcome = run(words);
      EXPECT_EQ(outcome.exitCode, 3) << outcome.err;
      EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
      EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
      if (!kSanitized) {
        EXPECT_LT(outcome.peakBytes, kLeastBytes) << part;
      }
      EXPECT_FALSE(std::filesystem::exists(folder / "m.ply"));
    }
  }

  const test::ScratchFolder folder;
  const std::string file = folder / "bomb.vdb";
};

/// Leaves of one value: some bytes in the file, two kilobytes in memory, with vectors six.
template <class GridT>
openvdb::GridBase::Ptr makeSolid(int side) {
  using Value = typename GridT::ValueType;
  const auto grid = GridT::create(openvdb::zeroVal<Value>());
  grid->setName("bomb");
  for (auto at = openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(side - 1)).begin(); at;
       ++at) {
    grid->tree()
        .touchLeaf(openvdb::Coord(8 * (*at)[0], 8 * (*at)[1], 8 * (*at)[2]))
        ->fill(Value(1), true);
  }
  return grid;
}

/// As tight as the format stores a surface through every cell: of 512 inactive values of two kinds
/// a bit each.
openvdb::GridBase::Ptr makeNoise(int side) {
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("bomb");
  std::mt19937 random(1);
  for (auto at = openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(side - 1)).begin(); at;
       ++at) {
    auto* const leaf =
        grid->tree().touchLeaf(openvdb::Coord(8 * (*at)[0], 8 * (*at)[1], 8 * (*at)[2]));
    for (openvdb::Index n = 0; n < leaf->SIZE; ++n) {
      leaf->setValueOff(n, random() % 2 == 0 ? 1.0f : -1.0f);
    }
  }
  return grid;
}

/// The sign changes from voxel to voxel: the surface touches itself everywhere.
openvdb::GridBase::Ptr makeCheckerboard(int side) {
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("bomb");
  for (auto at = openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(8 * side - 1)).begin(); at;
       ++at) {
    grid->tree().setValueOff(*at, (((*at)[0] + (*at)[1] + (*at)[2]) & 1) != 0 ? 1.0f : -1.0f);
  }
  return grid;
}

constexpr std::uint32_t kCodecs[] = {COMPRESS_ZIP, COMPRESS_ZIP | COMPRESS_ACTIVE_MASK,
                                     COMPRESS_BLOSC, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK};

TEST_F(Bombs, OfOneValueTakeMemoryInProportion) {
  const auto numbers = makeSolid<openvdb::FloatGrid>(30);
  const auto vectors = makeSolid<openvdb::Vec3SGrid>(20);
  for (const std::uint32_t codec : kCodecs) {
    expectBomb(numbers, codec, 8);
    expectProportion({"info", file}, 100);
    expectBomb(vectors, codec, 20);
    expectProportion({"info", file}, 100);
  }
  expectBomb(makeSolid<openvdb::FloatGrid>(20), COMPRESS_ZIP, 8);
  expectProportion({"mesh", file, "--iso", "0.5", "--quiet", "-o", folder / "m.ply"}, 100);
}

TEST_F(Bombs, OfNoiseTakeMemoryInProportion) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer takes memory of its own";
  write(makeNoise(6), COMPRESS_ZIP | COMPRESS_ACTIVE_MASK);
  expectProportion({"mesh", file, "--iso", "0", "--uniform", "--quiet", "-o", folder / "m.ply"},
                   1500);
  write(makeNoise(4), COMPRESS_ZIP | COMPRESS_ACTIVE_MASK);
  expectProportion({"mesh", file, "--iso", "0", "--quiet", "-o", folder / "m.ply"}, 4000);
  write(makeNoise(3), COMPRESS_ZIP | COMPRESS_ACTIVE_MASK);
  expectProportion({"chunks", file, "--iso", "0", "--quiet", "-o", folder / "c"}, 4000);
}

// Thirty pairs a voxel intersect before repair, which took 7.5 KB a voxel.
TEST_F(Bombs, OfACheckerboardTakeMemoryInProportion) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer takes memory of its own";
  write(makeCheckerboard(3), COMPRESS_ZIP | COMPRESS_ACTIVE_MASK);
  expectProportion({"mesh", file, "--iso", "0", "--uniform", "--quiet", "-o", folder / "m.ply"},
                   4000);
}

// An STL with one far vertex took 2.3 GB.
TEST_F(Bombs, OfOneFarVertexAreRefusedOrTakeWhatTheirBandTakes) {
  Mesh mesh;
  mesh.triangles = {Triangle(0, 2, 1), Triangle(0, 1, 3), Triangle(1, 2, 3), Triangle(2, 0, 3)};
  const auto voxelizeNeedle = [&](double height, std::uint64_t bandVoxels) {
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, height}};
    tufa::write(mesh, folder / "far.stl");
    return run({"voxelize", folder / "far.stl", "--voxel", "0.1", "--band-voxels",
                std::to_string(bandVoxels), "--quiet", "-o", file});
  };
  for (const double height : {1e6, 1e8}) {
    const auto outcome = voxelizeNeedle(height, std::uint64_t{1} << 27);
    EXPECT_EQ(outcome.exitCode, height < 1e7 ? 3 : 2) << height << ": a band too long, or too far";
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    if (!kSanitized) {
      EXPECT_LT(outcome.peakBytes, kLeastBytes) << height;
    }
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  EXPECT_NE(voxelizeNeedle(1e6, 8'000'000).err.find("--band-voxels"), std::string::npos);
  const auto outcome = voxelizeNeedle(2000, 8'000'000);
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  constexpr std::uint64_t kVoxelBytes = 40;
  if (!kSanitized) {
    EXPECT_LT(outcome.peakBytes, kLeastBytes + kVoxelBytes * 8'000'000);
  }
}

/// A file of one leaf, whose values are the last bytes.
class LeafFile {
 public:
  explicit LeafFile(std::string bytes) : bytes_(std::move(bytes)) {
    // A size, then as many bytes to the end.
    for (values_ = bytes_.size() - 9; sizeAt(values_) != bytes_.size() - values_ - 8;) --values_;
  }

  /// With other bytes in place of the values: the size before them and the grid's end fit.
  [[nodiscard]] std::string with(const std::string& packed, std::uint64_t size) const {
    std::string bytes = bytes_.substr(0, values_ + 8) + packed;
    std::memcpy(bytes.data() + values_, &size, sizeof size);
    // Behind the type and the parent of no name: the places of the grid, its blocks and its end.
    const std::size_t end = bytes.find("Tree_float_5_4_3") + 16 + 4 + 16;
    const std::uint64_t length = bytes.size();
    std::memcpy(bytes.data() + end, &length, sizeof length);
    return bytes;
  }

 private:
  [[nodiscard]] std::uint64_t sizeAt(std::size_t place) const {
    std::uint64_t size = 0;
    std::memcpy(&size, bytes_.data() + place, sizeof size);
    return size;
  }
  std::string bytes_;
  std::size_t values_ = 0;
};

/// Zeros in deflate. Ours are gone before the command begins: it would count them as its own.
std::string deflated(std::size_t bytes) {
  const std::string zeros(bytes, '\0');
  std::string packed(compressBound(zeros.size()), '\0');
  uLongf length = packed.size();
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &length,
                     reinterpret_cast<const Bytef*>(zeros.data()), zeros.size()),
            Z_OK);
  return packed.substr(0, length);
}

/// Zeros in a chunk of Blosc.
std::string bloscPacked(std::size_t bytes) {
  const std::string zeros(bytes, '\0');
  std::size_t length = 0;
  const auto chunk = openvdb::compression::bloscCompress(zeros.data(), bytes, length, true);
  return chunk == nullptr ? "" : std::string(chunk.get(), length);
}

/// A leaf has room for 2048 bytes.
TEST_F(Bombs, OfZipForOneLeafAreRefused) {
  write(makeSolid<openvdb::FloatGrid>(1), COMPRESS_ZIP);
  const LeafFile leaf(readBytes(file));
  const std::string packed = deflated(256 * kMegabyte);
  const std::uint64_t length = packed.size();
  EXPECT_LT(length, 256 * kMegabyte / 1000);
  expectRefusal(leaf.with(packed, length), "holds more than its 2048 bytes of values");
  for (const std::uint64_t claim : {length + 1, std::uint64_t{1} << 40}) {
    expectRefusal(leaf.with(packed, claim), "claims a compressed buffer");
  }
}

TEST_F(Bombs, OfBloscForOneLeafAreRefused) {
  write(makeSolid<openvdb::FloatGrid>(1), COMPRESS_BLOSC);
  const LeafFile leaf(readBytes(file));
  std::string packed = bloscPacked(256 * kMegabyte);
  const std::uint64_t length = packed.size();
  ASSERT_GT(length, 16u);
  EXPECT_LT(length, 256 * kMegabyte / 100);
  expectRefusal(leaf.with(packed, length), "claims to hold 268435456 bytes");
  // The head says what there is room for, the blocks are as large as before, or larger.
  const auto set = [&](std::size_t word, std::uint32_t value) {
    std::memcpy(packed.data() + 4 * word, &value, sizeof value);
  };
  set(1, 2048);
  for (const std::uint32_t block : {1u << 18, 1u << 30, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
    set(2, block);
    expectRefusal(leaf.with(packed, length), "bomb.vdb");
  }
  expectRefusal(leaf.with(packed, std::uint64_t{1} << 40), "claims a compressed buffer");
}

/// One grid under many names would be read as often.
TEST_F(Bombs, OfGridsThatShareTheirBytesAreRefused) {
  const auto one = makeSolid<openvdb::FloatGrid>(1);
  const auto two = makeSolid<openvdb::FloatGrid>(1);
  two->setName("two");
  {
    openvdb::io::File out(file);
    out.write({one, two});
  }
  EXPECT_EQ(run({"info", file}).exitCode, 0);
  std::string bytes = readBytes(file);
  const std::size_t first = bytes.find("Tree_float_5_4_3") + 16 + 4;
  const std::size_t second = bytes.find("Tree_float_5_4_3", first) + 16 + 4;
  std::memcpy(bytes.data() + second, bytes.data() + first, 8);
  expectRefusal(bytes, "two of its grids lie at byte");
}

}  // namespace
}  // namespace tufa
