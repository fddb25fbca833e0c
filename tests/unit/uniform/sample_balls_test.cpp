#include "uniform/sample_balls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/block_field.h"

namespace tufa::uniform {
namespace {

// A wedge of 40 degrees that points along x, its tip at x = 6, cut off at some x.
struct BluntWedge {
  double end;
  double operator()(const Vec3& p) const {
    const double half = 20 * 3.14159265358979 / 180;
    const Vec3 at(p[0] - 6, p[1] - 3.3, 0);
    const double side = at[0] * std::sin(half) + std::abs(at[1]) * std::cos(half);
    return std::max(side, p[0] - end);
  }
};

bool admits(const test::BlockField& field, const Vec3& point) {
  const auto accessor = field.blocks().accessor();
  return SampleBalls(field.scale(), *accessor, Coord(0)).admit(point);
}

TEST(SampleBalls, AdmitTheTipOfAWedge) {
  const auto field = test::distanceAroundBlock(BluntWedge{6});
  for (const double z : {2.0, 2.5, 3.9}) EXPECT_TRUE(admits(field, {6, 3.3, z}));
  EXPECT_FALSE(admits(field, {7.5, 3.3, 3}));
}

// Where its sides would meet there is nothing.
TEST(SampleBalls, RefuseTheTipOfABluntWedge) {
  const auto field = test::distanceAroundBlock(BluntWedge{4.5});
  EXPECT_FALSE(admits(field, {6, 3.3, 3}));
  EXPECT_TRUE(admits(field, {4.5, 3.3, 3}));
}

// A point is counted from any lattice point.
TEST(SampleBalls, CountFromALatticePoint) {
  const auto field = test::distanceAroundBlock(BluntWedge{6});
  const auto accessor = field.blocks().accessor();
  const SampleBalls balls(field.scale(), *accessor, Coord(5, 2, 4));
  EXPECT_TRUE(balls.admit({1, 1.3, -1}));
  EXPECT_FALSE(balls.admit({6, 3.3, 3}));
}

}  // namespace
}  // namespace tufa::uniform
