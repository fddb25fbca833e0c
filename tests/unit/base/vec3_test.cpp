#include "base/vec3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/print.h"

namespace tufa {
namespace {

TEST(Vec3, IsThePositionAndTheNormalItCameFrom) {
  const Position position(1, -2, 3.5);
  EXPECT_EQ(Position(Vec3(position)), position);
  const Normal normal(0.25F, -0.5F, 0.75F);
  EXPECT_EQ(Normal(Vec3(normal)), normal);
  EXPECT_EQ(Vec3(Coord(-7, 0, 2147483647)), Vec3(-7, 0, 2147483647.0));
}

TEST(Vec3, CrossProductIsRightHandedAndAcrossBoth) {
  EXPECT_EQ(Vec3(1, 0, 0).cross(Vec3(0, 1, 0)), Vec3(0, 0, 1));
  EXPECT_EQ(Vec3(0, 1, 0).cross(Vec3(0, 0, 1)), Vec3(1, 0, 0));
  const Vec3 a(2, -3, 5), b(-1, 4, 7);
  EXPECT_EQ(a.cross(b).dot(a), 0);
  EXPECT_EQ(a.cross(b).dot(b), 0);
  // Lagrange: the squared area.
  EXPECT_EQ(a.cross(b).squaredLength(),
            a.squaredLength() * b.squaredLength() - a.dot(b) * a.dot(b));
}

TEST(Vec3, NormalizeLeavesVectorsThatAreTooShort) {
  Vec3 v(0, 3, -4);
  EXPECT_TRUE(v.normalize());
  EXPECT_LT((v - Vec3(0, 0.6, -0.8)).length(), 1e-15);
  Vec3 tiny(0, 0, 1e-8);
  EXPECT_FALSE(tiny.normalize());
  EXPECT_EQ(tiny, Vec3(0, 0, 1e-8));
  EXPECT_TRUE(tiny.normalize(1e-9));
  EXPECT_EQ(tiny, Vec3(0, 0, 1));
  Vec3 none(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  EXPECT_FALSE(none.normalize());
}

TEST(Vec3, UnitOrXHasADirectionForEveryVector) {
  EXPECT_EQ(Vec3(0, 0, -3).unitOrX(), Vec3(0, 0, -1));
  EXPECT_EQ(Vec3(0.0).unitOrX(), Vec3(1, 0, 0));
}

TEST(Vec3, IsOrderedByXThenYThenZ) {
  EXPECT_TRUE(Vec3(1, 9, 9) < Vec3(2, 0, 0));
  EXPECT_TRUE(Vec3(1, 1, 9) < Vec3(1, 2, 0));
  EXPECT_TRUE(Vec3(1, 1, 1) < Vec3(1, 1, 2));
  EXPECT_FALSE(Vec3(1, 1, 1) < Vec3(1, 1, 1));
  EXPECT_FALSE(Vec3(2, 0, 0) < Vec3(1, 9, 9));
}

TEST(Vec3, IsFiniteIfAllThreeAre) {
  EXPECT_TRUE(Vec3(1e308, -1e308, 0).isFinite());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double bad : {std::numeric_limits<double>::infinity(), std::nan("")}) {
      Vec3 v(1);
      v[axis] = bad;
      EXPECT_FALSE(v.isFinite());
    }
  }
}

TEST(Vec3, LeastAndGreatestAreTakenAxisByAxis) {
  const Vec3 a(1, 5, -3), b(2, 4, -3);
  EXPECT_EQ(minVec3(a, b), Vec3(1, 4, -3));
  EXPECT_EQ(maxVec3(a, b), Vec3(2, 5, -3));
}

TEST(Vec3, FloorsDownwardBelowZeroToo) {
  EXPECT_EQ(floorCoord(Vec3(1.9, -0.1, -2)), Coord(1, -1, -2));
}

TEST(Coord, ShiftsFloorAndScaleBelowZeroToo) {
  EXPECT_EQ(Coord(-1, -8, 9) >> 3, Coord(-1, -1, 1));
  EXPECT_EQ(Coord(-1, 2, 0) << 3, Coord(-8, 16, 0));
  EXPECT_EQ(Coord(-1, -8, 9) & 7, Coord(7, 0, 1));
}

TEST(Coord, IsOrderedByXThenYThenZ) {
  EXPECT_LT(Coord(-1, 9, 9), Coord(0, 0, 0));
  EXPECT_LT(Coord(0, 0, 9), Coord(0, 1, 0));
  EXPECT_LT(Coord(0, 0, 0), Coord(0, 0, 1));
}

TEST(Coord, OffsetsAndDifferencesUndoEachOther) {
  const Coord a(3, -4, 5), b(-10, 0, 7);
  EXPECT_EQ(a + b - b, a);
  EXPECT_EQ(a.offsetBy(1, 2, 3), Coord(4, -2, 8));
  EXPECT_EQ(a.offsetBy(-2), Coord(1, -6, 3));
}

}  // namespace
}  // namespace tufa
