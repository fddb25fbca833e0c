#include "base/quadric.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace tufa::base {
namespace {

struct Plane {
  Vec3 point, normal;
};

// Planes with normals of any length.
std::vector<Plane> randomPlanes(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3(number(random), number(random), number(random)); };
  std::vector<Plane> planes;
  for (int i = 0; i < count; ++i) planes.push_back({vector(), vector()});
  return planes;
}

Quadric sumOf(const std::vector<Plane>& planes) {
  Quadric sum;
  for (const Plane& plane : planes) sum.addPlane(plane.point, plane.normal);
  return sum;
}

double errorAt(const std::vector<Plane>& planes, const Vec3& x) {
  double sum = 0;
  for (const Plane& plane : planes) sum += std::pow(plane.normal.dot(x - plane.point), 2);
  return sum;
}

TEST(Quadric, IsTheSumOfSquaredDistancesToItsPlanes) {
  const auto planes = randomPlanes(1, 7);
  const Quadric sum = sumOf(planes);
  EXPECT_EQ(sum.count, 7);
  for (const Plane& at : randomPlanes(2, 50)) {
    EXPECT_NEAR(sum.at(at.point), errorAt(planes, at.point), 1e-12);
  }
}

TEST(Quadric, OfNoPlanesIsZeroEverywhere) { EXPECT_EQ(Quadric().at(Vec3(3, -2, 5)), 0); }

TEST(Quadric, OfTwoSetsIsTheSumOfBoth) {
  const auto some = randomPlanes(3, 4), others = randomPlanes(4, 5);
  Quadric both = sumOf(some);
  both += sumOf(others);
  const Vec3 x(0.3, -0.7, 0.2);
  EXPECT_NEAR(both.at(x), errorAt(some, x) + errorAt(others, x), 1e-12);
  EXPECT_EQ(both.count, 9);
  Vec3 normals(0.0);
  for (const auto* planes : {&some, &others}) {
    for (const Plane& plane : *planes) normals += plane.normal;
  }
  EXPECT_LT((both.normals - normals).length(), 1e-12);
}

TEST(Quadric, TranslatedHasTheSameErrorAtTheSamePlaces) {
  const auto planes = randomPlanes(5, 6);
  const Vec3 origin(10, -20, 5);
  const Quadric moved = sumOf(planes).translatedTo(origin);
  for (const Plane& at : randomPlanes(6, 50)) {
    EXPECT_NEAR(moved.at(at.point - origin), errorAt(planes, at.point), 1e-10);
  }
}

// Rounding could make a small one so.
TEST(Quadric, IsNeverNegative) {
  for (unsigned seed = 7; seed < 40; ++seed) {
    const Vec3 far(1e6, -1e6, 1e6);
    const Plane plane = randomPlanes(seed, 1).front();
    Quadric one;
    one.addPlane(far + plane.point, plane.normal);
    EXPECT_GE(one.at(far + plane.point), 0);
  }
}

}  // namespace
}  // namespace tufa::base
