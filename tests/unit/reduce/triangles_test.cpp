#include "reduce/triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "reduce/halving.h"

namespace tufa::reduce {
namespace {

TEST(Triangles, WithoutAreaHaveNearestPoints) {
  const Vec3f a(0, 0, 0), c(1, 0, 0);
  for (const Vec3f p : {Vec3f(2, 1, 0), Vec3f(0.25f, 1, 0), Vec3f(-1, 1, 0), a, c}) {
    const float x = std::clamp(p.x, 0.0f, 1.0f);
    const float truth = squaredLength(p - Vec3f(x, 0, 0));
    EXPECT_NEAR(squaredDistanceToTriangle(p, a, a, c), truth, 1e-6f);
    EXPECT_NEAR(squaredDistanceToTriangle(p, a, c, a), truth, 1e-6f);
    EXPECT_NEAR(squaredDistanceToTriangle(p, c, a, a), truth, 1e-6f);
    EXPECT_NEAR(exactSquaredDistanceToTriangle(p, a, a, c), static_cast<double>(truth), 1e-6);
    EXPECT_NEAR(squaredDistanceToTriangle(p, a, a, a), squaredLength(p), 1e-6f);
  }
}

// The order of the candidates does not count.
TEST(Triangles, WithoutAreaAreBoundedByHalving) {
  const Vec3f degenerate[3] = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}};
  const Vec3f below[3] = {{0, 0, -5}, {1, 0, -5}, {0, 1, -5}};
  const auto distance = [&](Vec3f q, Index i) {
    const Vec3f* t = i == 0 ? degenerate : below;
    return std::sqrt(squaredDistanceToTriangle(q, t[0], t[1], t[2]));
  };
  const Corners face = {Vec3f(1, 0, 3), Vec3f(2, 0, 3), Vec3f(1, 1, 3)};
  const float first = Halving(distance, Sphere{{}, kEverywhere}, 0.1f).bound(face, {0, 1});
  const float last = Halving(distance, Sphere{{}, kEverywhere}, 0.1f).bound(face, {1, 0});
  EXPECT_NEAR(first, std::sqrt(10.0f), 0.01f);
  EXPECT_NEAR(last, std::sqrt(10.0f), 0.01f);
}

// However far from the origin they are.
TEST(Triangles, ThatMeetHaveNoPlaneBetweenThem) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unitRange(-1, 1);
  const auto point = [&](float size) {
    return Vec3f(unitRange(random), unitRange(random), unitRange(random)) * size;
  };
  int tried = 0;
  for (const float offset : {0.0f, 4000.0f, 50000.0f}) {
    const Vec3f origin = Vec3f(1, 0.7f, -0.9f) * offset;
    for (int i = 0; i < 20000; ++i) {
      Vec3f a[3] = {point(2), point(2), point(2)};
      const Vec3f normal = unit(cross(a[1] - a[0], a[2] - a[0]));
      if (length(cross(a[1] - a[0], a[2] - a[0])) < 2) continue;
      const Vec3f middle = (a[0] + a[1] + a[2]) * (1.0f / 3);
      // One corner below the other triangle, two above.
      Vec3f b[3] = {middle - normal * 0.02f, middle + normal * 0.5f + point(0.4f),
                    middle + normal * 0.5f + point(0.4f)};
      for (Vec3f& p : a) p = p + origin;
      for (Vec3f& p : b) p = p + origin;
      const Vec3 n = (Vec3(a[1]) - Vec3(a[0])).cross(Vec3(a[2]) - Vec3(a[0]));
      if (n.dot(Vec3(b[0]) - Vec3(a[0])) > -5e-3 * n.length()) continue;  // by rounding
      ++tried;
      ASSERT_FALSE(planeParts(a, b, 1e-4f)) << offset;
    }
  }
  EXPECT_GT(tried, 10000);
  const Vec3f a[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, b[3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  EXPECT_TRUE(planeParts(a, b, 0.9f));
  EXPECT_FALSE(planeParts(a, b, 1.1f));
}

}  // namespace
}  // namespace tufa::reduce
