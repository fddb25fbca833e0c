#include "grid/tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "grid/blocks.h"
#include "grid/samples.h"
#include "grid/vdb_coord.h"
#include "support/fields.h"
#include "support/print.h"

namespace tufa::grid {
namespace {

using openvdb::DoubleGrid;
using openvdb::FloatGrid;

template <class GridT>
class TreeOf : public testing::Test {};
using GridTypes = testing::Types<FloatGrid, DoubleGrid>;
TYPED_TEST_SUITE(TreeOf, GridTypes);

TYPED_TEST(TreeOf, HasTheLeavesOfTheGrid) {
  const auto grid = test::randomTree<TypeParam>({.seed = 3});
  base::Job job(1, {});
  const auto tree = treeOf(*grid, job);
  ASSERT_EQ(tree->leafCount(), grid->tree().leafCount());
  std::set<Coord> origins;
  for (std::size_t i = 0; i < tree->leafCount(); ++i) {
    const auto leaf = static_cast<LeafRef>(i);
    const Coord origin = tree->leafOrigin(leaf);
    EXPECT_TRUE(origins.insert(origin).second) << origin << " came twice";
    for (int cell = 0; cell < kBlockCells; ++cell) {
      const auto at = toVdb(origin.offsetBy(cell >> 6, (cell >> 3) & 7, cell & 7));
      ASSERT_EQ(tree->leafValue(leaf, cell), static_cast<double>(grid->tree().getValue(at))) << at;
      ASSERT_EQ(((tree->leafActive(leaf, cell >> 6) >> (cell & 63)) & 1) != 0,
                grid->tree().isValueOn(at))
          << at;
    }
  }
}

TYPED_TEST(TreeOf, ReadsLeavesTilesAndBackgroundAlike) {
  auto grid = TypeParam::create(3);
  grid->tree().addTile(1, openvdb::Coord(8, 0, 0), -1, true);
  grid->tree().addTile(2, openvdb::Coord(-128, 0, 0), -2, false);
  grid->tree().setValue(openvdb::Coord(0, 0, 7), 5);
  base::Job job(1, {});
  const auto accessor = treeOf(*grid, job)->accessor();
  struct Expected {
    Coord at;
    double value;
    bool active;
  };
  for (const Expected& expected :
       {Expected{{0, 0, 7}, 5, true}, Expected{{0, 0, 6}, 3, false}, Expected{{8, 0, 7}, -1, true},
        Expected{{15, 7, 0}, -1, true}, Expected{{16, 0, 0}, 3, false},
        Expected{{-1, 127, 0}, -2, false}, Expected{{-1, 128, 0}, 3, false},
        Expected{{-100000, 4, 7}, 3, false}}) {
    EXPECT_EQ(accessor->value(expected.at), expected.value) << expected.at;
    EXPECT_EQ(accessor->isActive(expected.at), expected.active) << expected.at;
  }
}

// Compares the samples of all blocks, and those one layer below and two above, with the tree's.
template <class GridT>
void expectSamples(const GridT& grid, const FieldScale& scale) {
  base::Job job(1, {});
  const Blocks blocks(treeOf(grid, job), {scale.isovalue, true}, NonFinite::Outside, job);
  const auto accessor = blocks.accessor();
  ASSERT_GT(blocks.count(), 0U);
  BlockSamples samples;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const auto block = static_cast<BlockRef>(i);
    samples.gather(blocks, scale, block, blocks.neighbours(block, *accessor), *accessor);
    for (int x = -1; x <= 9; ++x) {
      for (int y = -1; y <= 9; ++y) {
        for (int z = -1; z <= 9; ++z) {
          const auto at = toVdb(blocks.origin(block).offsetBy(x, y, z));
          const double value = static_cast<double>(grid.tree().getValue(at));
          const double expected =
              std::isfinite(value) ? (value - scale.isovalue) * scale.factor : 1;
          ASSERT_NEAR(static_cast<double>(samples[BlockSamples::index(x, y, z)]), expected, 1e-6)
              << at;
        }
      }
    }
  }
}

TYPED_TEST(TreeOf, GathersWhatItHoldsAtBordersOfLeavesTilesAndNodes) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    // Around the origin, where eight nodes meet, and where two do.
    const openvdb::Coord first =
        seed % 2 == 0 ? openvdb::Coord(-24, -16, -24) : openvdb::Coord(104, -8, 112);
    expectSamples(*test::randomTree<TypeParam>({.seed = seed, .first = first}),
                  {.isovalue = 0.25, .factor = -3});
  }
}

TYPED_TEST(TreeOf, GathersNonFiniteSamplesAsAVoxelOutside) {
  auto grid = test::noise<TypeParam>({.size = 12, .first = openvdb::Coord(-4)});
  using Value = typename TypeParam::ValueType;
  grid->tree().setValue(openvdb::Coord(0), std::numeric_limits<Value>::quiet_NaN());
  grid->tree().setValue(openvdb::Coord(-1, 3, 7), std::numeric_limits<Value>::infinity());
  grid->tree().setValue(openvdb::Coord(5, 5, 5), -std::numeric_limits<Value>::infinity());
  expectSamples(*grid, {});
}

TEST(SampleReader, ReadsWhatTheBlocksSamplesHold) {
  const auto grid = test::randomTree<FloatGrid>({.seed = 9});
  const FieldScale scale{.isovalue = 0.1, .factor = 2};
  base::Job job(1, {});
  const Blocks blocks(treeOf(*grid, job), {scale.isovalue, true}, NonFinite::Refuse, job);
  const auto accessor = blocks.accessor();
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const auto block = static_cast<BlockRef>(i);
    const Neighbours neighbours = blocks.neighbours(block, *accessor);
    const SampleReader reader(blocks, scale, block, neighbours, *accessor);
    for (const Coord& at : {Coord(0), Coord(-8, 15, 3), Coord(8, -1, 7), Coord(15), Coord(-8)}) {
      const auto there = toVdb(blocks.origin(block) + at);
      const double value = (static_cast<double>(grid->tree().getValue(there)) - 0.1) * 2;
      EXPECT_NEAR(reader.at(at[0], at[1], at[2]), value, 1e-6) << there;
    }
  }
}

TEST(SampleReader, TellsEdgesBetweenActiveSamples) {
  const auto grid = test::randomTree<FloatGrid>({.seed = 11});
  base::Job job(1, {});
  const Blocks blocks(treeOf(*grid, job), {0, true}, NonFinite::Refuse, job);
  const auto accessor = blocks.accessor();
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const auto block = static_cast<BlockRef>(i);
    const Neighbours neighbours = blocks.neighbours(block, *accessor);
    const SampleReader reader(blocks, {}, block, neighbours, *accessor);
    for (int cell = 0; cell < kBlockCells; ++cell) {
      const auto lower = toVdb(blocks.origin(block).offsetBy(cell >> 6, (cell >> 3) & 7, cell & 7));
      const auto edges = reader.activeEdges(cell >> 6);
      for (int axis = 0; axis < 3; ++axis) {
        auto upper = lower;
        ++upper[axis];
        ASSERT_EQ(((edges[axis] >> (cell & 63)) & 1) != 0,
                  grid->tree().isValueOn(lower) && grid->tree().isValueOn(upper))
            << lower << " along " << axis;
      }
    }
  }
}

}  // namespace
}  // namespace tufa::grid
