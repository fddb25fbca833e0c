#include "base/small_angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace tufa::base {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

TEST(SmallAngles, AreThoseOppositeTheShortestEdge) {
  const std::vector<Position> positions = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 0, 1e-9}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {1, 2, 0}, {2, 1, 0}};
  SmallAngles angles;
  angles.add(positions, triangles, 36.8);  // that of a triangle of 3, 4 and 5 is 36.87
  EXPECT_NEAR(angles.smallest, std::atan2(3, 4) * kDegrees, 1e-12);
  EXPECT_EQ(angles.below, 0U);
  angles.add(positions, triangles, 36.9);
  EXPECT_EQ(angles.below, 3U);
  angles.add(positions, std::vector<Triangle>{{0, 1, 3}}, 36.9);
  EXPECT_NEAR(angles.smallest, 1e-9 / 4 * kDegrees, 1e-20);
  EXPECT_EQ(angles.below, 4U);
}

TEST(SmallAngles, OfTrianglesWithoutAreaAreZero) {
  const std::vector<Position> positions = {{0, 0, 0}, {3, 0, 0}, {1, 0, 0}};
  SmallAngles angles;
  EXPECT_EQ(angles.smallest, 180);
  angles.add(positions, std::vector<Triangle>{{0, 1, 2}}, 1);
  EXPECT_EQ(angles.smallest, 0);
  angles.add(positions, std::vector<Triangle>{{0, 0, 1}}, 1);
  EXPECT_EQ(angles.below, 2U);
}

}  // namespace
}  // namespace tufa::base
