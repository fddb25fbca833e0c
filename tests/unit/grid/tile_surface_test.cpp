#include "grid/tile_surface.h"

#include <gtest/gtest.h>

#include <tufa/contour.h>
#include <tufa/shapes.h>
#include <limits>

#include "grid/tree.h"
#include "support/expect_error.h"

namespace tufa::grid {
namespace {

using openvdb::FloatGrid;

constexpr int kRootLevel = 3, kUpperLevel = 2, kLowerLevel = 1;

std::uint64_t facesOf(const FloatGrid& grid) {
  base::Job job(1, {});
  return tileSurface(grid.tree(), {0, true}, job);
}

std::uint64_t square(std::uint64_t side) { return side * side; }

TEST(TileSurface, IsThatOfOneTile) {
  for (const auto& [level, side] :
       {std::pair{kLowerLevel, 8U}, {kUpperLevel, 128U}, {kRootLevel, 4096U}}) {
    for (const float background : {1.F, -1.F}) {
      const auto grid = FloatGrid::create(background);
      grid->tree().addTile(level, openvdb::Coord(0), -background, false);
      EXPECT_EQ(facesOf(*grid), 6 * square(side)) << level;
      grid->tree().addTile(level, openvdb::Coord(0), background, true);
      EXPECT_EQ(facesOf(*grid), 0U) << level;
    }
  }
}

TEST(TileSurface, CountsNothingBetweenTilesOfOneSide) {
  const auto grid = FloatGrid::create(1);
  grid->tree().addTile(kRootLevel, openvdb::Coord(0), -1, false);
  grid->tree().addTile(kRootLevel, openvdb::Coord(4096, 0, 0), -2, true);
  EXPECT_EQ(facesOf(*grid), 10 * square(4096));
  grid->tree().addTile(kRootLevel, openvdb::Coord(-4096, 0, 0), 2, true);
  EXPECT_EQ(facesOf(*grid), 10 * square(4096));
}

TEST(TileSurface, LooksIntoNodesBesideATile) {
  const auto grid = FloatGrid::create(1);
  grid->tree().addTile(kRootLevel, openvdb::Coord(0), -1, false);
  grid->tree().addTile(kUpperLevel, openvdb::Coord(-128, 0, 0), -1,
                       false);  // covers a part of a face
  EXPECT_EQ(facesOf(*grid), 6 * square(4096) - square(128) + 5 * square(128));
  grid->tree().addTile(kLowerLevel, openvdb::Coord(4096, 8, 8), -1, false);
  EXPECT_EQ(facesOf(*grid), 6 * square(4096) - square(128) + 5 * square(128) + 4 * square(8));
  // A leaf brings its own bytes.
  grid->tree().touchLeaf(openvdb::Coord(4096, 80, 80));
  EXPECT_EQ(facesOf(*grid),
            6 * square(4096) - square(128) + 5 * square(128) + 4 * square(8) - square(8));
}

TEST(TileSurface, OfALevelSetIsNone) {
  ShapeOptions options;
  options.voxelSize = 0.005;
  const auto ball = makeShape(Shape::Sphere, options);
  EXPECT_GT(ball->tree().root().childCount(), 0U);
  EXPECT_EQ(facesOf(*ball), 0U);
}

TEST(TileSurface, StopsAtTheEndsOfCoordinates) {
  constexpr std::int32_t kFirst = std::numeric_limits<std::int32_t>::min();
  const auto grid = FloatGrid::create(1);
  grid->tree().addTile(kRootLevel, openvdb::Coord(kFirst, 0, 0), -1, false);
  EXPECT_EQ(facesOf(*grid), 5 * square(4096));
}

/// A tile of 4096^3 voxels took 1 GB and 12 s, and 64 of them all memory there was.
TEST(TileSurface, AboveTheLimitIsRefused) {
  for (const int count : {1, 64}) {
    const auto grid = FloatGrid::create(1);
    for (int n = 0; n < count; ++n) {
      grid->tree().addTile(kRootLevel, openvdb::Coord(8192 * n, 0, 0), -1, true);
    }
    const std::string faces = std::to_string(count * 6 * square(4096));
    for (const bool uniform : {true, false}) {
      ContourOptions options;
      options.uniform = uniform;
      test::expectError(ErrorCode::LimitExceeded, "about " + faces + " faces of voxels",
                        [&] { (void)contour(*grid, options); });
      test::expectError(ErrorCode::LimitExceeded, "ContourOptions::tileFaces",
                        [&] { (void)contour(*grid, options); });
    }
  }
  const auto grid = FloatGrid::create(1);
  grid->tree().addTile(kUpperLevel, openvdb::Coord(0), -1, true);
  ContourOptions options;
  options.tileFaces = 6 * square(128) - 1;
  test::expectError(ErrorCode::LimitExceeded, "faces", [&] { (void)contour(*grid, options); });
  ++options.tileFaces;
  EXPECT_GT(contour(*grid, options).triangleCount(), 0U);
}

}  // namespace
}  // namespace tufa::grid
