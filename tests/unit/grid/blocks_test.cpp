#include "grid/blocks.h"

#include <gtest/gtest.h>

#include <tufa/error.h>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "grid/vdb_coord.h"
#include "support/fields.h"
#include "support/lattice.h"

namespace tufa::grid {
namespace {

using openvdb::CoordBBox;
using openvdb::DoubleGrid;
using openvdb::FloatGrid;
using tufa::test::crossedEdgesOf;
using tufa::test::randomTree;

template <class GridT>
class BlocksOf : public testing::Test {};
using GridTypes = testing::Types<FloatGrid, DoubleGrid>;
TYPED_TEST_SUITE(BlocksOf, GridTypes);

Blocks blocksOf(const openvdb::GridBase& grid, const IsoChoice& iso,
                NonFinite nonFinite = NonFinite::Refuse) {
  base::Job job(2, {});
  return Blocks(treeOf(grid, job), iso, nonFinite, job);
}

// Compares the side of every sample of every block with the tree's.
template <class GridT>
void expectSides(const GridT& grid, const IsoChoice& iso, NonFinite nonFinite = NonFinite::Refuse) {
  const auto blocks = blocksOf(grid, iso, nonFinite);
  ASSERT_GT(blocks.count(), 0U);
  const auto accessor = blocks.accessor();
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const auto block = static_cast<BlockRef>(i);
    for (int cell = 0; cell < kBlockCells; ++cell) {
      const openvdb::Coord at =
          toVdb(blocks.origin(block).offsetBy(cell >> 6, (cell >> 3) & 7, cell & 7));
      const auto value = grid.tree().getValue(at);
      const bool inside =
          std::isfinite(value) && (iso.insideIsBelow ? value < iso.isovalue : value > iso.isovalue);
      ASSERT_EQ(blocks.inside(block).get(cell), inside) << at << " " << value;
      ASSERT_EQ(((blocks.active(block, cell >> 6, *accessor) >> (cell & 63)) & 1) != 0,
                grid.tree().isValueOn(at));
    }
  }
}

TYPED_TEST(BlocksOf, SidesAreThoseOfTheSamples) {
  for (const bool below : {true, false}) {
    for (const double isovalue : {0.0, 0.1, -0.7, 1e-30}) {
      expectSides(*tufa::test::noise<TypeParam>({.size = 20, .seed = 5}), {isovalue, below});
    }
    // Samples on the isovalue are outside.
    for (const double isovalue : {-1.0, 0.0, 2.0}) {
      expectSides(*tufa::test::noise<TypeParam>({.size = 20, .seed = 6, .wholeNumbers = true}),
                  {isovalue, below});
    }
  }
}

TYPED_TEST(BlocksOf, IsovalueThatFloatCannotHoldSeparatesItsNeighbours) {
  // 0.1 lies between two floats; the samples are those two and the doubles around it.
  using Value = typename TypeParam::ValueType;
  const double isovalue = 0.1;
  const auto nearest = static_cast<Value>(isovalue);
  const Value infinity = std::numeric_limits<Value>::infinity();
  const std::array<Value, 3> values = {std::nextafter(nearest, -infinity), nearest,
                                       std::nextafter(nearest, infinity)};
  int next = 0;
  const auto grid =
      tufa::test::sampled<TypeParam>(CoordBBox(openvdb::Coord(0), openvdb::Coord(7)), 1,
                                     [&](const openvdb::Coord&) { return values[next++ % 3]; });
  expectSides(*grid, {isovalue, true});
  expectSides(*grid, {isovalue, false});
  expectSides(*grid, {static_cast<double>(nearest), true});
  expectSides(*grid, {static_cast<double>(nearest), false});
}

TYPED_TEST(BlocksOf, NonFiniteSamplesAreOutside) {
  using Value = typename TypeParam::ValueType;
  auto grid = tufa::test::noise<TypeParam>({.size = 16, .seed = 7});
  std::mt19937 random(7);
  const std::array<Value, 3> bad = {std::numeric_limits<Value>::quiet_NaN(),
                                    std::numeric_limits<Value>::infinity(),
                                    -std::numeric_limits<Value>::infinity()};
  std::size_t count = 0;
  for (auto value = grid->beginValueOn(); value; ++value) {
    if (random() % 50 == 0) value.setValue(bad[count++ % 3]);
  }
  for (const bool below : {true, false}) {
    expectSides(*grid, {0, below}, NonFinite::Outside);
    EXPECT_EQ(blocksOf(*grid, {0, below}, NonFinite::Outside).nonFiniteValues(), count);
  }
}

TEST(Blocks, RefusalNamesTheGridTheCountAndTheFirstCoordinate) {
  auto grid = tufa::test::noise<FloatGrid>({.size = 16, .first = openvdb::Coord(0)});
  grid->setName("density");
  grid->tree().setValue(openvdb::Coord(9, 3, 4), std::numeric_limits<float>::quiet_NaN());
  grid->tree().setValue(openvdb::Coord(1, 12, 7), std::numeric_limits<float>::infinity());
  try {
    (void)blocksOf(*grid, {0, true});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::NonFiniteValues);
    EXPECT_NE(std::string(error.what()).find("grid \"density\" holds 2 NaN or infinite values"),
              std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("(1, 12, 7)"), std::string::npos) << error.what();
  }
}

TEST(Blocks, NonFiniteTilesAndBackgroundsAreRefused) {
  auto grid = FloatGrid::create(1);
  grid->tree().addTile(1, openvdb::Coord(8, 16, 24), std::numeric_limits<float>::quiet_NaN(), true);
  EXPECT_THROW((void)blocksOf(*grid, {0, true}), Error);
  const auto background = FloatGrid::create(std::numeric_limits<float>::infinity());
  EXPECT_THROW((void)blocksOf(*background, {0, true}), Error);
}

// Every crossed edge of a window around the data, against the tree read sample by sample; inside
// first below, then above.
template <class GridT>
void expectAllCrossedEdges(const GridT& grid, const CoordBBox& window, double isovalue = 0) {
  for (const bool below : {true, false}) {
    const IsoChoice iso{isovalue, below};
    const auto expected = crossedEdgesOf(grid.tree(), iso, window);
    EXPECT_TRUE(crossedEdgesOf(blocksOf(grid, iso), window) == expected)
        << expected.size() << " expected, inside " << (below ? "below" : "above");
  }
}

TYPED_TEST(BlocksOf, FindAllCrossedEdgesOfRandomTrees) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    // The seam between nodes at the origin, and one between lower nodes.
    const openvdb::Coord first =
        seed % 2 == 0 ? openvdb::Coord(-24, -16, -24) : openvdb::Coord(104, -8, 112);
    const int blocks = 5;
    const auto grid = randomTree<TypeParam>(
        {.seed = seed, .first = first, .blocks = blocks, .background = seed % 3 == 0 ? -1.0 : 1.0});
    expectAllCrossedEdges(*grid, CoordBBox(first.offsetBy(-9), first.offsetBy(8 * blocks + 8)));
  }
}

TEST(Blocks, FindTheSurfaceOneStepBelowALeaf) {
  for (const double background : {1.0, -1.0}) {
    for (const openvdb::Coord& corner : {openvdb::Coord(0, 0, 0), openvdb::Coord(7, 7, 7),
                                         openvdb::Coord(0, 3, 7), openvdb::Coord(4, 0, 0)}) {
      auto grid = FloatGrid::create(static_cast<float>(background));
      grid->tree().setValue(openvdb::Coord(-8, 16, 4096) + corner, static_cast<float>(-background));
      expectAllCrossedEdges(*grid,
                            CoordBBox(openvdb::Coord(-20, 4, 4084), openvdb::Coord(12, 36, 4116)));
    }
  }
}

TEST(Blocks, FindTheSurfaceBetweenTiles) {
  // Tiles that touch in a face, an edge and a corner, on both sides of node seams.
  const std::array<openvdb::Coord, 4> steps = {openvdb::Coord(8, 0, 0), openvdb::Coord(0, 8, 8),
                                               openvdb::Coord(-8, 8, -8), openvdb::Coord(0, 0, -8)};
  for (const openvdb::Coord& first :
       {openvdb::Coord(-8, -8, -8), openvdb::Coord(120, 0, 4088), openvdb::Coord(0, 64, 32)}) {
    for (const openvdb::Coord& step : steps) {
      for (const float background : {1.0F, -1.0F}) {
        auto grid = FloatGrid::create(background);
        grid->tree().addTile(1, first, -1, true);
        grid->tree().addTile(1, first + step, 1, false);
        expectAllCrossedEdges(*grid, CoordBBox(first.offsetBy(-18), first.offsetBy(26)));
      }
    }
  }
}

TEST(Blocks, FindTheSurfaceOfALargeTile) {
  const openvdb::Coord origin(-128, 128, 3968);
  for (const float background : {1.0F, -1.0F}) {
    auto grid = FloatGrid::create(background);
    grid->tree().addTile(2, origin, -background, true);
    // Beside it a small tile, one past its edge, and a leaf at its corner.
    grid->tree().addTile(1, origin.offsetBy(128, 128, 0), -background, true);
    grid->tree().setValue(origin.offsetBy(-1), -background);
    grid->tree().setValue(origin.offsetBy(64, 64, 128), -background);
    const IsoChoice iso{0, true};
    const CoordBBox around(origin.offsetBy(-10), origin.offsetBy(140));
    const auto found = crossedEdgesOf(blocksOf(*grid, iso), around);
    EXPECT_TRUE(found == crossedEdgesOf(grid->tree(), iso, around));
    // Six sides of the large tile, less what the small one and the leaf cover.
    EXPECT_GT(found.size(), 6U * 128 * 128);
  }
}

TEST(Blocks, FindTheSurfaceBetweenLargeTilesAndLeavesInside) {
  // Large tiles of both sides next to each other, in a background of one of them.
  auto grid = FloatGrid::create(1);
  grid->tree().addTile(2, openvdb::Coord(0), -1, true);
  grid->tree().addTile(2, openvdb::Coord(128, 0, 0), 1, true);
  grid->tree().addTile(2, openvdb::Coord(0, 128, 128), -1, false);
  grid->tree().touchLeaf(openvdb::Coord(120, 128, 0))->fill(-1.0F);
  const IsoChoice iso{0, true};
  const auto blocks = blocksOf(*grid, iso);
  for (const openvdb::Coord& corner :
       {openvdb::Coord(0), openvdb::Coord(128, 0, 0), openvdb::Coord(128, 128, 0),
        openvdb::Coord(128, 128, 128), openvdb::Coord(0, 128, 128), openvdb::Coord(0, 256, 256),
        openvdb::Coord(128, 0, 128)}) {
    const CoordBBox window(corner.offsetBy(-20), corner.offsetBy(20));
    EXPECT_TRUE(crossedEdgesOf(blocks, window) == crossedEdgesOf(grid->tree(), iso, window))
        << corner;
  }
}

TEST(Blocks, FindTheSurfaceAtARootTile) {
  // A background inside and a root tile of the same side, so that only what is put at the tile's
  // sides is surface: leaf, small tile and large tile outside, one beyond each kind of seam.
  for (const float background : {-1.0F, 1.0F}) {
    auto grid = FloatGrid::create(background);
    grid->tree().addTile(3, openvdb::Coord(0), background, true);
    grid->tree().addTile(1, openvdb::Coord(-8, 16, 24), -background, true);
    grid->tree().addTile(2, openvdb::Coord(128, -128, 256), -background, false);
    grid->tree().touchLeaf(openvdb::Coord(4096, 80, 96))->fill(-background);
    grid->tree().touchLeaf(openvdb::Coord(-8, -8, -8))->fill(-background);
    grid->tree().addTile(1, openvdb::Coord(4096, 4096, 4096), -background, true);
    const IsoChoice iso{0, true};
    const auto blocks = blocksOf(*grid, iso);
    for (const openvdb::Coord& around :
         {openvdb::Coord(-4, 20, 28), openvdb::Coord(128, 0, 256), openvdb::Coord(256, 0, 384),
          openvdb::Coord(4096, 84, 100), openvdb::Coord(0), openvdb::Coord(4096),
          openvdb::Coord(200, -2, 300)}) {
      const CoordBBox window(around.offsetBy(-20), around.offsetBy(20));
      const auto expected = crossedEdgesOf(grid->tree(), iso, window);
      EXPECT_FALSE(expected.empty());
      EXPECT_TRUE(crossedEdgesOf(blocks, window) == expected) << around;
    }
  }
}

TEST(Blocks, CountActiveVoxelsOfLeavesAndTiles) {
  auto grid = FloatGrid::create(1);
  grid->tree().addTile(1, openvdb::Coord(0), -1, true);
  grid->tree().addTile(1, openvdb::Coord(64), -1, false);
  grid->tree().addTile(2, openvdb::Coord(128), 1, true);
  grid->tree().setValue(openvdb::Coord(-5), -1);
  EXPECT_EQ(blocksOf(*grid, {0, true}).activeVoxels(), 512U + 128U * 128U * 128U + 1U);
}

TEST(Blocks, OfAnEmptyTreeAreNone) {
  const auto grid = FloatGrid::create(1);
  EXPECT_EQ(blocksOf(*grid, {0, true}).count(), 0U);
}

}  // namespace
}  // namespace tufa::grid
