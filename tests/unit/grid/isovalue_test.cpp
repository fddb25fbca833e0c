#include "grid/isovalue.h"

#include <gtest/gtest.h>

#include <tufa/error.h>
#include <limits>

#include "support/fields.h"

namespace tufa::grid {
namespace {

using openvdb::CoordBBox;
using openvdb::FloatGrid;

FloatGrid::Ptr rampGrid(float background, openvdb::GridClass gridClass) {
  auto grid = test::sampled<FloatGrid>(CoordBBox(openvdb::Coord(0), openvdb::Coord(0, 0, 4)),
                                       background, [](const openvdb::Coord& at) { return at.z(); });
  grid->setGridClass(gridClass);
  return grid;
}

TEST(Isovalue, OfALevelSetIsZeroAndInsideIsBelow) {
  const IsoChoice iso = chooseIsovalue(*rampGrid(8, openvdb::GRID_LEVEL_SET), {}, Inside::Auto);
  EXPECT_EQ(iso.isovalue, 0);
  EXPECT_TRUE(iso.insideIsBelow);
}

TEST(Isovalue, OfAFogVolumeIsHalfWayAndInsideIsAbove) {
  const IsoChoice iso = chooseIsovalue(*rampGrid(0, openvdb::GRID_FOG_VOLUME), {}, Inside::Auto);
  EXPECT_EQ(iso.isovalue, 2);
  EXPECT_FALSE(iso.insideIsBelow);
}

TEST(Isovalue, OfOtherGridsCountsTheBackgroundAndLeavesItOutside) {
  const IsoChoice high = chooseIsovalue(*rampGrid(10, openvdb::GRID_UNKNOWN), {}, Inside::Auto);
  EXPECT_EQ(high.isovalue, 5);
  EXPECT_TRUE(high.insideIsBelow);
  const IsoChoice low = chooseIsovalue(*rampGrid(-2, openvdb::GRID_UNKNOWN), {}, Inside::Auto);
  EXPECT_EQ(low.isovalue, 1);
  EXPECT_FALSE(low.insideIsBelow);
}

TEST(Isovalue, CallerDecides) {
  const auto grid = rampGrid(10, openvdb::GRID_LEVEL_SET);
  const IsoChoice above = chooseIsovalue(*grid, 1.25, Inside::Above);
  EXPECT_EQ(above.isovalue, 1.25);
  EXPECT_FALSE(above.insideIsBelow);
  EXPECT_TRUE(chooseIsovalue(*grid, 1.25, Inside::Below).insideIsBelow);
}

TEST(Isovalue, IgnoresNonFiniteSamples) {
  auto grid = rampGrid(0, openvdb::GRID_FOG_VOLUME);
  grid->tree().setValue(openvdb::Coord(1), std::numeric_limits<float>::quiet_NaN());
  grid->tree().setValue(openvdb::Coord(2), std::numeric_limits<float>::infinity());
  EXPECT_EQ(chooseIsovalue(*grid, {}, Inside::Auto).isovalue, 2);
}

TEST(Isovalue, MustBeFinite) {
  const auto grid = rampGrid(0, openvdb::GRID_FOG_VOLUME);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)chooseIsovalue(*grid, bad, Inside::Auto), Error);
  }
}

TEST(Isovalue, SamplesOnItOrNotFiniteAreOutside) {
  for (const bool below : {true, false}) {
    const IsoChoice iso{0.5, below};
    EXPECT_FALSE(isInside(0.5, iso));
    EXPECT_EQ(isInside(0.25, iso), below);
    EXPECT_EQ(isInside(0.75, iso), !below);
    EXPECT_FALSE(isInside(std::numeric_limits<double>::quiet_NaN(), iso));
    EXPECT_FALSE(isInside(std::numeric_limits<double>::infinity(), iso));
    EXPECT_FALSE(isInside(-std::numeric_limits<double>::infinity(), iso));
  }
}

}  // namespace
}  // namespace tufa::grid
