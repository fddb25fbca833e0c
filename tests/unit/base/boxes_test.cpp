#include <gtest/gtest.h>

#include <random>

#include "base/box.h"
#include "base/index_box.h"
#include "support/print.h"

namespace tufa::base {
namespace {

TEST(IndexBox, IsEmptyUntilSomethingIsAdded) {
  IndexBox box;
  EXPECT_TRUE(box.isEmpty());
  EXPECT_EQ(box.size(), Coord(0));
  EXPECT_FALSE(box.contains(Coord(0)));
  box.add(Coord(-3, 4, 0));
  EXPECT_FALSE(box.isEmpty());
  EXPECT_EQ(box.size(), Coord(1));
  EXPECT_TRUE(box.contains(Coord(-3, 4, 0)));
}

TEST(IndexBox, HoldsBothItsCorners) {
  const IndexBox box{Coord(-1, 0, 2), Coord(1, 0, 5)};
  EXPECT_EQ(box.size(), Coord(3, 1, 4));
  EXPECT_EQ(box.centre(), Vec3(0, 0, 3.5));
  int held = 0;
  for (int x = -3; x <= 3; ++x) {
    for (int y = -3; y <= 3; ++y) {
      for (int z = 0; z <= 8; ++z) held += box.contains(Coord(x, y, z)) ? 1 : 0;
    }
  }
  EXPECT_EQ(held, 3 * 1 * 4);
  EXPECT_TRUE(box.contains(box.min));
  EXPECT_TRUE(box.contains(box.max));
}

TEST(IndexBox, GrowsOnAllSides) {
  const IndexBox box = IndexBox{Coord(0), Coord(7)}.grownBy(2);
  EXPECT_EQ(box.min, Coord(-2));
  EXPECT_EQ(box.max, Coord(9));
}

TEST(Box, OfNothingGrowsFromItsFirstPoint) {
  Box box = Box::empty();
  EXPECT_TRUE(box.isEmpty());
  box.add(Vec3(1, -2, 3));
  EXPECT_FALSE(box.isEmpty());
  EXPECT_EQ(box.lower, Vec3(1, -2, 3));
  EXPECT_EQ(box.upper, Vec3(1, -2, 3));
  box.add(Box{Vec3(0, 0, 0), Vec3(2, 2, 2)});
  EXPECT_EQ(box.size(), Vec3(2, 4, 3));
  EXPECT_EQ(box.centre(), Vec3(1, 0, 1.5));
}

TEST(Box, MeetsWhatTouchesIt) {
  const Box box{Vec3(0), Vec3(1)};
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step(0);
    step[axis] = 1;
    EXPECT_TRUE(box.meets({box.lower + step, box.upper + step}));
    EXPECT_TRUE(box.meets({box.lower - step, box.upper - step}));
    EXPECT_FALSE(box.meets({box.lower + step * 1.001, box.upper + step}));
    EXPECT_FALSE(box.meets({box.lower - step * 2, box.upper - step * 1.001}));
  }
  EXPECT_TRUE(box.meets({Vec3(0.4), Vec3(0.6)})) << "one in the other";
  EXPECT_FALSE(box.meets(Box::empty()));
}

TEST(Box, DistanceIsThatOfTheNearestOfItsPoints) {
  const Box box{Vec3(-1, 0, 2), Vec3(1, 0.5, 3)};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-4, 6), share(0, 1);
  for (int i = 0; i < 200; ++i) {
    const Vec3 point(place(random), place(random), place(random));
    const double squared = box.distanceSquared(point);
    Vec3 foot;
    for (int axis = 0; axis < 3; ++axis) {
      foot[axis] = std::min(std::max(point[axis], box.lower[axis]), box.upper[axis]);
    }
    EXPECT_DOUBLE_EQ(squared, (point - foot).squaredLength());
    for (int j = 0; j < 20; ++j) {
      const Vec3 size = box.size();
      const Vec3 other = box.lower + Vec3(size[0] * share(random), size[1] * share(random),
                                          size[2] * share(random));
      EXPECT_GE((point - other).squaredLength(), squared);
    }
  }
}

}  // namespace
}  // namespace tufa::base
