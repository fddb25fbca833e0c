#include "base/flat_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace tufa::base {
namespace {

// The least distance of many points of the triangle.
double sampled(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr int kSteps = 200;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const double s = static_cast<double>(i) / kSteps, t = static_cast<double>(j) / kSteps;
      least = std::min(least, (a + (b - a) * s + (c - a) * t - point).length());
    }
  }
  return least;
}

class RandomPoints {
 public:
  Vec3 next() { return {uniform_(engine_), uniform_(engine_), uniform_(engine_)}; }

 private:
  std::mt19937 engine_{7};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

void expectDistance(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double found = std::sqrt(squaredDistanceTo(point, a, b, c));
  const double near = sampled(point, a, b, c);
  EXPECT_LE(found, near + 1e-9);
  EXPECT_GE(found, near - 0.02);
  EXPECT_NEAR(found, std::sqrt(FlatTriangle(a, b, c).squaredDistance(point)), 1e-7);
}

TEST(FlatTriangle, FindsTheDistanceOfAnyPoint) {
  RandomPoints random;
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random.next(), b = random.next(), c = random.next();
    expectDistance(random.next(), a, b, c);
  }
}

TEST(FlatTriangle, FindsTheDistanceOfItsOwnPoints) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  for (const Vec3& point : {a, b, c, (a + b) * 0.5, (b + c) * 0.5, (a + b + c) / 3.0}) {
    EXPECT_NEAR(squaredDistanceTo(point, a, b, c), 0, 1e-30);
    EXPECT_NEAR(squaredDistanceTo(point + Vec3(0, 0, 2), a, b, c), 4, 1e-12);
  }
}

TEST(FlatTriangle, FindsTheDistanceToAnEmptyOne) {
  RandomPoints random;
  for (int i = 0; i < 100; ++i) {
    const Vec3 a = random.next(), b = random.next(), point = random.next();
    const double side = std::sqrt(squaredDistanceTo(point, a, b, b));
    EXPECT_NEAR(side, sampled(point, a, b, b), 0.02);
    EXPECT_NEAR(std::sqrt(squaredDistanceTo(point, a, b, (a + b) * 0.5)), side, 1e-7);
    EXPECT_NEAR(std::sqrt(squaredDistanceTo(point, a, a, a)), (point - a).length(), 1e-12);
  }
}

}  // namespace
}  // namespace tufa::base
