// Trees in .vdb files: every way in which OpenVDB writes them is read, and each size in them that
// is false is refused, before OpenVDB believes it.

#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointConversion.h>

#include <tufa/io.h>
#include <array>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <random>

#include "base/leaf_source.h"
#include "io/grid/tree_walker.h"
#include "support/expect_error.h"
#include "support/openvdb_templates.h"
#include "support/scratch_folder.h"

namespace tufa {
namespace {

using namespace openvdb::io;
using test::expectError;
using test::readBytes;
using test::ScratchFolder;
using test::writeBytes;

constexpr std::uint32_t kCompressions[] = {COMPRESS_NONE,  COMPRESS_ACTIVE_MASK,
                                           COMPRESS_ZIP,   COMPRESS_ZIP | COMPRESS_ACTIVE_MASK,
                                           COMPRESS_BLOSC, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK};

template <class Value>
Value makeValue(double x) {
  if constexpr (openvdb::VecTraits<Value>::IsVec) {
    return Value(static_cast<typename Value::ValueType>(x));
  } else {
    return static_cast<Value>(x);
  }
}

/// Leaves and tiles on all levels, whose inactive values are of one, two, three and many kinds.
template <class GridT>
typename GridT::Ptr makeVaried(double background) {
  using Value = typename GridT::ValueType;
  openvdb::initialize();
  auto grid = GridT::create(makeValue<Value>(background));
  auto& tree = grid->tree();
  std::mt19937 random(1);
  const auto below = [&](int end) { return static_cast<int>(random() % 1000) % end; };
  const auto fill = [&](const openvdb::Coord& origin, int active, int kinds) {
    auto* const leaf = tree.touchLeaf(origin);
    for (openvdb::Index n = 0; n < leaf->SIZE; ++n) {
      const bool on = below(8) < active;
      const double value = on ? below(1000) : below(kinds) * 3.0 - background;
      leaf->setValueOnly(n, makeValue<Value>(value));
      leaf->setActiveState(n, on);
    }
  };
  int x = 0;
  for (const int active : {0, 1, 4, 8}) {
    for (const int kinds : {1, 2, 3, 100}) fill(openvdb::Coord(8 * x++, 0, 0), active, kinds);
  }
  fill(openvdb::Coord(-8), 3, 1);
  fill(openvdb::Coord(-8, 5000, 16), 8, 1);
  tree.addTile(1, openvdb::Coord(0, 64, 0), makeValue<Value>(2), true);
  tree.addTile(1, openvdb::Coord(0, 64, 64), makeValue<Value>(3), false);
  tree.addTile(2, openvdb::Coord(0, 1024, 0), makeValue<Value>(4), true);
  tree.addTile(3, openvdb::Coord(4096, 8192, -4096), makeValue<Value>(5), true);
  return grid;
}

void writeWith(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids,
               std::uint32_t compression) {
  File file(path);
  file.setCompression(compression);
  file.write(grids);
}

/// Where the tree of the first grid begins: at its number of buffers, which is one, and background.
template <class Value>
std::size_t findTree(const std::string& bytes, const Value& background) {
  std::string head("\1\0\0\0", 4);
  head.append(reinterpret_cast<const char*>(&background), sizeof background);
  const std::size_t place = bytes.find(head, bytes.find("ScaleMap"));
  EXPECT_NE(place, std::string::npos);
  return place;
}

template <class GridT>
class TreeFiles : public ::testing::Test {};

// Values of all sizes, with and without a form in half precision; bools and masks, which leaves
// store in other ways. Each further type is seconds of compiling.
using GridTypes =
    ::testing::Types<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                     openvdb::Vec3SGrid, openvdb::Vec3DGrid, openvdb::BoolGrid, openvdb::MaskGrid>;
TYPED_TEST_SUITE(TreeFiles, GridTypes);

TYPED_TEST(TreeFiles, OfEveryKindAreRead) {
  const ScratchFolder folder;
  for (const std::uint32_t compression : kCompressions) {
    for (const bool half : {false, true}) {
      auto grid = makeVaried<TypeParam>(half ? 1 : 0);
      grid->setName("grid");
      grid->setSaveFloatAsHalf(half);
      auto twin = grid->copy();
      twin->setName("twin");
      writeWith(folder / "m.vdb", {grid, twin}, compression);
      File file(folder / "m.vdb");
      file.open(false);
      const auto expected = openvdb::gridPtrCast<TypeParam>(file.readGrid("grid"));
      for (const char* name : {"grid", "twin"}) {
        const auto back = openvdb::gridPtrCast<TypeParam>(readGrid(folder / "m.vdb", name));
        ASSERT_TRUE(back->tree().hasSameTopology(grid->tree())) << compression;
        for (auto value = expected->cbeginValueAll(); value; ++value) {
          ASSERT_EQ(back->tree().getValue(value.getCoord()), *value) << compression;
        }
      }
    }
  }
}

/// Compares the values of each leaf, and its active voxels, with those of the grid read at once.
template <class GridT>
void expectLeafByLeaf(const std::filesystem::path& path, const std::string& name) {
  GridFile file(path, name);
  ASSERT_FALSE(file.isLoaded());
  const auto outline = openvdb::gridConstPtrCast<GridT>(file.outline());
  const auto whole = openvdb::gridPtrCast<GridT>(readGrid(path, name));
  ASSERT_TRUE(outline->tree().hasSameTopology(whole->tree()));
  std::vector<const typename GridT::TreeType::LeafNodeType*> leaves;
  whole->tree().getNodes(leaves);
  // Backwards, too, and one twice.
  std::vector<std::size_t> order(leaves.size());
  std::iota(order.begin(), order.end(), 0);
  order.insert(order.end(), order.rbegin(), order.rend());
  for (const std::size_t n : order) {
    std::array<typename GridT::ValueType, 512> values;
    file.leaves()->read(n, values.data());
    for (openvdb::Index i = 0; i < 512; ++i) ASSERT_EQ(values[i], leaves[n]->getValue(i)) << n;
  }
  EXPECT_TRUE(outline->tree().hasSameTopology(whole->tree()));
  for (auto leaf = outline->tree().cbeginLeaf(); leaf; ++leaf) {
    EXPECT_TRUE(leaf->buffer().empty()) << "the values are still in memory";
  }
  const auto loaded = openvdb::gridPtrCast<GridT>(file.load());
  EXPECT_TRUE(file.isLoaded());
  EXPECT_EQ(file.leaves(), nullptr);
  EXPECT_EQ(loaded, file.outline());
  for (auto value = whole->cbeginValueAll(); value; ++value) {
    ASSERT_EQ(loaded->tree().getValue(value.getCoord()), *value);
  }
}

TEST(TreeFiles, OfEveryCompressionAreReadLeafByLeaf) {
  const ScratchFolder folder;
  for (const std::uint32_t compression : kCompressions) {
    SCOPED_TRACE(compression);
    auto single = makeVaried<openvdb::FloatGrid>(1), half = makeVaried<openvdb::FloatGrid>(2);
    auto wide = makeVaried<openvdb::DoubleGrid>(3);
    single->setName("single"), half->setName("half"), wide->setName("wide");
    half->setSaveFloatAsHalf(true);
    writeWith(folder / "m.vdb", {single, half, wide}, compression);
    expectLeafByLeaf<openvdb::FloatGrid>(folder / "m.vdb", "single");
    expectLeafByLeaf<openvdb::FloatGrid>(folder / "m.vdb", "half");
    expectLeafByLeaf<openvdb::DoubleGrid>(folder / "m.vdb", "wide");
  }
}

/// The walk ends where the tree does: it knows the size of all that lies in it.
TYPED_TEST(TreeFiles, AreWalkedToTheirEnd) {
  const ScratchFolder folder;
  for (const std::uint32_t compression : kCompressions) {
    for (const bool half : {false, true}) {
      auto grid = makeVaried<TypeParam>(77);
      grid->setSaveFloatAsHalf(half);
      writeWith(folder / "m.vdb", {grid}, compression);
      const std::string bytes = readBytes(folder / "m.vdb");
      std::ifstream stream(folder / "m.vdb", std::ios::binary);
      stream.seekg(static_cast<std::streamoff>(findTree(bytes, grid->background())));
      const io::TreeCoding coding{openvdb::OPENVDB_FILE_VERSION, compression, half};
      io::TreeWalker walker(stream, bytes.size(), io::layoutOf(*grid).value(), coding);
      walker.walk();
      EXPECT_EQ(walker.place(), bytes.size()) << compression;
    }
  }
}

/// A file of a tree of one leaf, and where its parts lie. Its voxels are active, so that none of
/// its values is left out of the leaf.
struct LeafFile {
  std::string bytes;
  std::size_t tree = 0;    ///< the number of buffers
  std::size_t counts = 0;  ///< of tiles and of children of the root
  std::size_t origin = 0;  ///< of the root's child
  std::size_t upper = 0;   ///< two masks of 4096 bytes, values
  std::size_t lower = 0;   ///< two masks of 512 bytes, values
  std::size_t leaf = 0;    ///< a mask of 64 bytes, then the same again, then values
  std::size_t values = 0;  ///< of the leaf: behind the byte that says which are left out

  [[nodiscard]] std::int64_t sizeAt(std::size_t place) const {
    std::int64_t size = 0;
    std::memcpy(&size, bytes.data() + place, sizeof size);
    return size;
  }
  template <class T>
  [[nodiscard]] std::string with(std::size_t place, T value) const {
    std::string changed = bytes;
    std::memcpy(changed.data() + place, &value, sizeof value);
    return changed;
  }
};

template <class GridT>
LeafFile makeLeafFile(const ScratchFolder& folder, std::uint32_t compression, bool half,
                      bool noisy) {
  using Value = typename GridT::ValueType;
  openvdb::initialize();
  auto grid = GridT::create(makeValue<Value>(77));
  grid->setSaveFloatAsHalf(half);
  std::mt19937 random(1);
  auto* const leaf = grid->tree().touchLeaf(openvdb::Coord(0));
  for (openvdb::Index n = 0; n < leaf->SIZE; ++n) {
    const auto noise = static_cast<std::uint32_t>(random());
    leaf->setValueOn(n, makeValue<Value>(noisy ? noise / 131073.0 : 3.0));
  }
  writeWith(folder / "whole.vdb", {grid}, compression);
  LeafFile file;
  file.bytes = readBytes(folder / "whole.vdb");
  file.tree = findTree(file.bytes, grid->background());
  file.counts = file.tree + 4 + sizeof(Value);
  file.origin = file.counts + 8;
  file.upper = file.origin + 12;
  const bool sized = (compression & (COMPRESS_ZIP | COMPRESS_BLOSC)) != 0;
  const bool halved = half && RealToHalf<Value>::isReal;
  const std::size_t stored = halved ? sizeof(typename RealToHalf<Value>::HalfT) : sizeof(Value);
  const auto behindValues = [&](std::size_t place, std::size_t slots) {
    const bool all = (compression & COMPRESS_ACTIVE_MASK) == 0;
    const auto size = all ? static_cast<std::int64_t>(slots * stored) : 0;
    if (!sized) return place + 1 + static_cast<std::size_t>(size);
    if (!all && halved) return place + 1;
    return place + 9 + static_cast<std::size_t>(std::abs(file.sizeAt(place + 1)));
  };
  file.lower = behindValues(file.upper + 2 * 4096, 32768);
  file.leaf = behindValues(file.lower + 2 * 512, 4096);
  file.values = file.leaf + 2 * 64 + 1;
  return file;
}

void refuse(const ScratchFolder& folder, const std::string& bytes, const std::string& part) {
  SCOPED_TRACE(part);
  writeBytes(folder / "m.vdb", bytes);
  expectError(ErrorCode::UnreadableFile, part, [&] { (void)describeGrids(folder / "m.vdb"); });
  expectError(ErrorCode::UnreadableFile, part, [&] {
    GridFile file(folder / "m.vdb", listGrids(folder / "m.vdb").at(0).name);
    std::array<double, 512> values;
    if (file.leaves() != nullptr) file.leaves()->read(0, values.data());
  });
}

template <class GridT>
void refuseFalseSizes(const ScratchFolder& folder, std::uint32_t compression, bool half) {
  for (const bool noisy : {false, true}) {
    const auto file = makeLeafFile<GridT>(folder, compression, half, noisy);
    const std::int64_t size = file.sizeAt(file.values);
    ASSERT_EQ(file.values + 8 + static_cast<std::size_t>(std::abs(size)), file.bytes.size());
    writeBytes(folder / "m.vdb", file.bytes);
    ASSERT_EQ(describeGrids(folder / "m.vdb").at(0).activeVoxels, 512u);
    for (const std::size_t place : {file.values, file.lower + 1025, file.upper + 8193}) {
      // Of no values at all in half precision not even the size is written.
      if (place != file.values && half && (compression & COMPRESS_ACTIVE_MASK) != 0) continue;
      constexpr auto kLowest = std::numeric_limits<std::int64_t>::min();
      for (const std::int64_t claim : {std::int64_t{-1}, std::int64_t{-100000}, kLowest}) {
        refuse(folder, file.with(place, claim), "in place of");
      }
      for (const std::int64_t claim : {std::int64_t{18035573248}, std::int64_t{1} << 62}) {
        refuse(folder, file.with(place, claim), "are left");
      }
      // Not false by itself: the values do not unpack, or what follows makes no sense.
      for (const std::int64_t claim : {-size - 1, std::abs(size) + 1, std::int64_t{7}}) {
        refuse(folder, file.with(place, claim), "");
      }
    }
  }
}

template <class GridT>
void refuseFalseSizes(const ScratchFolder& folder) {
  for (const std::uint32_t compression : kCompressions) {
    if ((compression & (COMPRESS_ZIP | COMPRESS_BLOSC)) == 0) continue;
    for (const bool half : {false, true}) refuseFalseSizes<GridT>(folder, compression, half);
  }
}

TEST(DamagedTrees, ClaimFalseSizesOfBuffers) {
  const ScratchFolder folder;
  refuseFalseSizes<openvdb::FloatGrid>(folder);
  refuseFalseSizes<openvdb::DoubleGrid>(folder);
  refuseFalseSizes<openvdb::Vec3SGrid>(folder);
}

/// Bool leaves have no sizes, their parents have.
TEST(DamagedTrees, ClaimFalseSizesOfBools) {
  const ScratchFolder folder;
  for (const std::uint32_t compression : {COMPRESS_ZIP, COMPRESS_BLOSC}) {
    const auto file = makeLeafFile<openvdb::BoolGrid>(folder, compression, false, false);
    for (const std::size_t place : {file.upper + 8193, file.lower + 1025}) {
      refuse(folder, file.with(place, std::int64_t{-100000}), "in place of");
      refuse(folder, file.with(place, std::int64_t{18035573248}), "are left");
    }
    // Behind the mask of values lies the leaf's origin.
    refuse(folder, file.with(file.leaf + 128, 8), "another place");
    refuse(folder, file.with(file.tree + 4, std::uint8_t{2}), "a bool that is none");
  }
}

/// Blosc takes the lengths from the head of a chunk: data, blocks, chunk.
TEST(DamagedTrees, LieInTheHeadsOfBlosc) {
  const ScratchFolder folder;
  const auto file = makeLeafFile<openvdb::FloatGrid>(folder, COMPRESS_BLOSC, false, false);
  for (const std::size_t values : {file.values, file.lower + 1025, file.upper + 8193}) {
    for (const std::uint32_t claim : {0u, 2047u, 1u << 20, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
      refuse(folder, file.with(values + 8 + 4, claim), "claims to hold");
      refuse(folder, file.with(values + 8 + 12, claim), "a chunk of Blosc claims");
    }
  }
}

TEST(DamagedTrees, EndEarly) {
  const ScratchFolder folder;
  for (const std::uint32_t compression : kCompressions) {
    const auto file = makeLeafFile<openvdb::FloatGrid>(folder, compression, false, true);
    for (const std::size_t length : {file.counts, file.upper + 1, file.upper + 8193, file.lower + 9,
                                     file.leaf + 64, file.values, file.bytes.size() - 1}) {
      refuse(folder, file.bytes.substr(0, length), "truncated or damaged");
    }
    // As if the grid ended there: the place behind it is the last number before the grid.
    const std::size_t grid = file.bytes.find("Tree_float_5_4_3") + 16 + 4;
    ASSERT_EQ(file.sizeAt(grid + 16), static_cast<std::int64_t>(file.bytes.size()));
    refuse(folder, file.with(grid + 16, static_cast<std::int64_t>(file.values)), "");
  }
}

TEST(DamagedTrees, ClaimFalseCounts) {
  const ScratchFolder folder;
  const auto file = makeLeafFile<openvdb::FloatGrid>(folder, COMPRESS_ACTIVE_MASK, false, true);
  for (const std::uint32_t claim : {2u, 1000u, 0x7FFFFFFFu, 0xFFFFFFFFu}) {
    refuse(folder, file.with(file.counts + 4, claim), "");
    if (claim > 1000) refuse(folder, file.with(file.counts, claim), "tiles and 1 nodes");
  }
  for (const std::int32_t place : {1, -1, 4095, 2048, std::numeric_limits<std::int32_t>::max()}) {
    refuse(folder, file.with(file.origin + 4, place), "a node of 4096^3 voxels at index 0, ");
  }
}

TEST(DamagedTrees, HaveNodesWhereTheyMustNot) {
  const ScratchFolder folder;
  const auto file = makeLeafFile<openvdb::FloatGrid>(folder, COMPRESS_ACTIVE_MASK, false, true);
  // One more child, or its place an active tile too, in either inner node.
  for (const auto& [masks, bytes] : {std::pair(file.upper, 4096), std::pair(file.lower, 512)}) {
    refuse(folder, file.with(masks, std::uint8_t{3}), "");
    refuse(folder, file.with(masks + static_cast<std::size_t>(bytes), std::uint8_t{1}),
           "in place of an active tile");
  }
  for (const auto kind : {std::int8_t{-1}, std::int8_t{7}, std::int8_t{100}}) {
    refuse(folder, file.with(file.values - 1, kind), "no meaning");
  }
  auto two = makeVaried<openvdb::FloatGrid>(77);
  writeWith(folder / "two.vdb", {two}, COMPRESS_NONE);
  // The second tile or node of the root in the place of the first.
  std::string bytes = readBytes(folder / "two.vdb");
  const std::size_t tile = findTree(bytes, 77.0f) + 4 + 4 + 8;
  const std::size_t node = tile + 12 + 4 + 1;
  std::memcpy(bytes.data() + tile, bytes.data() + node, 12);
  refuse(folder, bytes, "one place");
}

/// Of points the tree is read, and not what its leaves hold.
TEST(DamagedTrees, OfPointsAreDescribed) {
  const ScratchFolder folder;
  openvdb::initialize();
  const std::vector<openvdb::Vec3R> places{{0, 0, 0}, {1, 2, 3}, {40, 5, 6}};
  const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  auto points =
      openvdb::points::createPointDataGrid<openvdb::points::NullCodec,
                                           openvdb::points::PointDataGrid>(places, *transform);
  points->setName("points");
  writeWith(folder / "m.vdb", {points, makeVaried<openvdb::FloatGrid>(1)}, COMPRESS_BLOSC);
  const auto infos = describeGrids(folder / "m.vdb");
  ASSERT_EQ(infos.size(), 2u);
  EXPECT_EQ(infos[0].activeVoxels, 3u);
  EXPECT_EQ(infos[0].leaves, 2u);
  EXPECT_EQ(infos[0].boundsMax[0], 40);
  EXPECT_NE(infos[0].whyNot.find("ptdataidx32"), std::string::npos);
  EXPECT_GT(infos[1].activeVoxels, 0u);
  const auto back = readGrid(folder / "m.vdb", "points");
  EXPECT_EQ(back->activeVoxelCount(), 3u);
  // A size of the first upper node's values.
  const auto bytes = readBytes(folder / "m.vdb");
  const std::size_t chunk =
      findTree(bytes, std::array<std::uint32_t, 3>{0, 0, 1}) + 4 + 4 + 8 + 12 + 8192 + 1;
  LeafFile file;
  file.bytes = bytes;
  refuse(folder, file.with(chunk, std::int64_t{-1000000}), "in place of");
}

/// OpenVDB takes as many bytes as a type of metadata has, whatever the file says.
TEST(DamagedTrees, ComeWithFalseMetadata) {
  const ScratchFolder folder;
  auto grid = makeVaried<openvdb::FloatGrid>(1);
  grid->insertMeta("number", openvdb::FloatMetadata(1.5f));
  grid->insertMeta("switch", openvdb::BoolMetadata(true));
  writeWith(folder / "whole.vdb", {grid}, COMPRESS_BLOSC);
  LeafFile file;
  file.bytes = readBytes(folder / "whole.vdb");
  const std::size_t number = file.bytes.find("float", file.bytes.find("number")) + 5;
  for (const std::uint32_t claim : {0u, 3u, 5u, 100u}) {
    refuse(folder, file.with(number, claim), "metadata of type float");
  }
  const std::size_t truth = file.bytes.find("bool", file.bytes.find("switch")) + 4;
  refuse(folder, file.with(truth + 4, std::uint8_t{2}), "a bool that is none");
  // The list of leaves: the value's length, count, chunk length, head of the chunk.
  const std::size_t list = file.bytes.find("__delayedload") + 13;
  const std::size_t name = file.bytes.find("file_delayed_load");
  ASSERT_LT(name, list);
  for (const std::uint32_t claim : {0x7FFFFFFFu, 1000u, 19u}) {
    refuse(folder, file.with(list + 4, claim), "");
    refuse(folder, file.with(list + 8, claim), "");
  }
}

/// The map within a frustum's map is not one of those again.
TEST(DamagedTrees, RefuseAFrustumWithinAFrustum) {
  const ScratchFolder folder;
  auto grid = makeVaried<openvdb::FloatGrid>(1);
  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 10, 1));
  writeWith(folder / "m.vdb", {grid}, COMPRESS_NONE);
  EXPECT_EQ(describeGrids(folder / "m.vdb").at(0).transform, "frustum");
  std::string bytes = readBytes(folder / "m.vdb");
  const std::string name = "NonlinearFrustumMap";
  const std::size_t second = bytes.find(name) + name.size() + 8 * sizeof(double);
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + second, sizeof length);
  const auto outer = static_cast<std::uint32_t>(name.size());
  bytes.replace(second, 4 + length, std::string(reinterpret_cast<const char*>(&outer), 4) + name);
  refuse(folder, bytes, "frustum within a frustum");
}

}  // namespace
}  // namespace tufa
