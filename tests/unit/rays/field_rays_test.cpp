// Rays to fields, against closed forms.

#include <gtest/gtest.h>
#include <tufa/rays.h>

#include <cmath>
#include <numbers>
#include <random>

#include "implicit/boxes.h"
#include "implicit/fields.h"
#include "support/expect_error.h"

namespace tufa {
namespace {

using implicit::FieldPtr;

/// The same numbers in every run.
class Numbers {
 public:
  double uniform(double least, double greatest) {
    return least + (greatest - least) * static_cast<double>(random_()) / 4294967295.0;
  }
  Vec3 point(double reach) {
    const double x = uniform(-reach, reach);
    const double y = uniform(-reach, reach);
    return {x, y, uniform(-reach, reach)};
  }

 private:
  std::mt19937 random_{24};
};

/// The nearer distance where a ray meets a sphere, of a ray that begins outside.
std::optional<double> sphereDistance(const Vec3& from, const Vec3& direction, const Vec3& centre,
                                     double radius) {
  const Vec3 offset = centre - from;
  const double along = offset.dot(direction);
  const double across = (offset - direction * along).length();
  if (across >= radius || along < 0) return std::nullopt;
  return along - std::sqrt((radius - across) * (radius + across));
}

TEST(FieldRays, MeetASmallSphereWheneverTheClosedFormDoes) {
  const Vec3 centre(0.31, -0.27, 0.12);
  constexpr double kRadius = 1e-3;
  const auto surface = makeRaySurface(implicit::combine(
      implicit::Operation::Union,
      {implicit::makeSphere(centre, kRadius), implicit::makeSphere({-1, -1, -1}, 0.05)}, 0));
  Numbers numbers;
  int hits = 0;
  for (int n = 0; n < 4000; ++n) {
    Vec3 from = numbers.point(1);
    from[2] = 2;
    // Up to the rim, as near as a millionth of the radius.
    const double rim = n % 4 == 0 ? 1 - std::pow(10, numbers.uniform(-6, -1)) : 1.1;
    const Vec3 aim = centre - from;
    const Vec3 side = aim.cross(numbers.point(1)).unitOrX();
    const double reach = n % 4 == 0 ? rim : numbers.uniform(0, rim);
    const Vec3 direction = (aim + side * (reach * kRadius)).unitOrX();
    const auto truth = sphereDistance(from, direction, centre, kRadius);
    const auto hit = castRay(*surface, {from, direction});
    ASSERT_EQ(hit.has_value(), truth.has_value()) << n;
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(hit->distance, *truth, 1e-9);
    ASSERT_NEAR((Vec3(hit->normal) - (Vec3(hit->point) - centre) / kRadius).length(), 0, 1e-5);
  }
  EXPECT_GT(hits, 3000);
}

TEST(FieldRays, MeetQuadricsAtTheirRoots) {
  Numbers numbers;
  int hits = 0;
  for (int n = 0; n < 16; ++n) {
    implicit::QuadricCoefficients c;
    for (double& number : c) number = numbers.uniform(-1, 1);
    const FieldPtr quadric = implicit::makeQuadric(c);
    const auto surface = makeRaySurface(implicit::combine(
        implicit::Operation::Intersection, {quadric, implicit::makeSphere({0, 0, 0}, 2)}, 0));
    for (int k = 0; k < 60; ++k) {
      const Vec3 from = numbers.point(1) + Vec3(0, 0, 4);
      const Vec3 direction = (numbers.point(1.5) - from).unitOrX();
      // A square function of the distance, by three of its values.
      const auto value = [&](double t) { return quadric->value(from + direction * t); };
      const double a = (value(1) + value(-1)) / 2 - value(0);
      const double b = (value(1) - value(-1)) / 2;
      const double discriminant = b * b - 4 * a * value(0);
      const auto enters = sphereDistance(from, direction, {0, 0, 0}, 2);
      if (!enters) continue;
      const double leaves = 2 * -Vec3(from).dot(direction) - *enters;
      double truth = value(*enters) < 0 ? *enters : leaves;
      if (value(*enters) >= 0 && discriminant > 0) {
        for (const double sign : {-1.0, 1.0}) {
          const double root = (-b + sign * std::sqrt(discriminant)) / (2 * a);
          if (root > *enters && root < truth) truth = root;
        }
      }
      const auto hit = castRay(*surface, {from, direction});
      ASSERT_EQ(hit.has_value(), truth < leaves) << n << " " << k;
      if (!hit) continue;
      ++hits;
      ASSERT_NEAR(hit->distance, truth, 1e-8);
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(FieldRays, BeginInsideAndEndEarly) {
  const auto surface = makeRaySurface(implicit::makeSphere({0, 0, 0}, 1));
  const auto leaves = castRay(*surface, {{0.5, 0, 0}, {2, 0, 0}});
  ASSERT_TRUE(leaves);
  EXPECT_NEAR(leaves->distance, 0.5, 1e-12);
  EXPECT_NEAR(leaves->normal.x, 1, 1e-6);
  EXPECT_FALSE(castRay(*surface, {{-3, 0, 0}, {1, 0, 0}, 0, 1.9}));
  const auto behind = castRay(*surface, {{-3, 0, 0}, {1, 0, 0}, 2.1});
  ASSERT_TRUE(behind);
  EXPECT_NEAR(behind->distance, 4, 1e-12);
  EXPECT_FALSE(castRay(*surface, {{3, 0, 0}, {1, 0, 0}}));
}

/// Where the field is 0 all along the ray there is nothing to find, and no end of halving.
TEST(FieldRays, MayRunInAFaceOrAlongAnEdge) {
  const auto box = makeRaySurface(implicit::makeBox({0, 0, 0}, {1, 1, 1}, 0));
  EXPECT_FALSE(castRay(*box, {{-3, 0, 1}, {1, 0, 0}}));
  EXPECT_FALSE(castRay(*box, {{-3, 1, 1}, {1, 0, 0}}));
  const auto touching = makeRaySurface(implicit::makeSphere({0, 0, 0}, 1));
  EXPECT_FALSE(castRay(*touching, {{-3, 0, 1}, {1, 0, 0}}));
}

/// Bounds say nothing of it at any length.
TEST(FieldRays, EndInFieldsWithoutBounds) {
  const auto bounds = implicit::makeBox({0, 0, 0}, {1, 1, 1}, 0);
  const auto surface = makeRaySurface(implicit::combine(
      implicit::Operation::Intersection, {implicit::makeExpression("1/0"), bounds}, 0));
  EXPECT_FALSE(castRay(*surface, {{-3, 0.2, 0.1}, {1, 0, 0}}));
}

TEST(FieldRays, NoThinSheetIsSteppedOver) {
  constexpr double kThickness = 1e-7;
  const auto sheet = makeRaySurface(implicit::makeBox({0, 0, 0}, {1, 1, kThickness / 2}, 0));
  Numbers numbers;
  for (int n = 0; n < 500; ++n) {
    const Vec3 aim(numbers.uniform(-0.9, 0.9), numbers.uniform(-0.9, 0.9), 0);
    const Vec3 from = numbers.point(1) + Vec3(0, 0, 3);
    const auto hit = castRay(*sheet, {from, aim - from});
    ASSERT_TRUE(hit) << n;
    ASSERT_NEAR(hit->point.z, kThickness / 2, 1e-12);
  }
}

TEST(FieldRays, RefuseWhatIsNoRay) {
  const auto sphere = makeRaySurface(implicit::makeSphere({0, 0, 0}, 1));
  test::expectError(ErrorCode::InvalidArgument, "direction", [&] {
    (void)castRay(*sphere, {{0, 0, 0}, {0, 0, 0}});
  });
  test::expectError(ErrorCode::InvalidArgument, "finite", [&] {
    (void)castRay(*sphere, {{0, 0, NAN}, {0, 0, 1}});
  });
  test::expectError(ErrorCode::InvalidArgument, "0 or more", [&] {
    (void)castRay(*sphere, {{0, 0, 0}, {0, 0, 1}, -1});
  });
  test::expectError(ErrorCode::InvalidArgument, "go on for ever", [&] {
    (void)makeRaySurface(implicit::makePlane({0, 0, 0}, {0, 0, 1}));
  });
}

}  // namespace
}  // namespace tufa
