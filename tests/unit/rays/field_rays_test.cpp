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

/// The same field without closed form: rays are searched by bounds.
class Searched final : public implicit::Field {
 public:
  explicit Searched(FieldPtr field) : field_(std::move(field)) {}
  [[nodiscard]] double value(const Position& p) const override { return field_->value(p); }
  [[nodiscard]] Position gradient(const Position& p) const override { return field_->gradient(p); }
  [[nodiscard]] implicit::Interval bound(const implicit::Box& box) const override {
    return field_->bound(box);
  }
  [[nodiscard]] double lipschitz(const implicit::Box& box) const override {
    return field_->lipschitz(box);
  }
  [[nodiscard]] implicit::Box gradientBound(const implicit::Box& box) const override {
    return field_->gradientBound(box);
  }
  [[nodiscard]] implicit::Box extent() const override { return field_->extent(); }

 private:
  FieldPtr field_;
};

TEST(FieldRays, MeetASmallSphereWheneverTheClosedFormDoes) {
  const Vec3 centre(0.31, -0.27, 0.12);
  constexpr double kRadius = 1e-3;
  const FieldPtr other = implicit::makeSphere({-1, -1, -1}, 0.05);
  const auto beside = [&](const FieldPtr& sphere) {
    return implicit::combine(implicit::Operation::Union, {sphere, other}, 0);
  };
  const FieldPtr sphere = implicit::makeSphere(centre, kRadius);
  const FieldPtr quadric =
      implicit::makeQuadric({1, 1, 1, 0, 0, 0, -2 * centre[0], -2 * centre[1], -2 * centre[2],
                             centre.squaredLength() - kRadius * kRadius});
  const std::shared_ptr<const RaySurface> surfaces[] = {
      makeRaySurface(beside(sphere)), makeRaySurface(std::make_shared<Searched>(beside(sphere))),
      makeRaySurface(beside(quadric))};
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
    for (const auto& surface : surfaces) {
      const auto hit = castRay(*surface, {from, direction});
      ASSERT_EQ(hit.has_value(), truth.has_value()) << n;
      if (!hit) continue;
      ++hits;
      // The quadric's constant is rounded, by 10^-11 of the squared radius.
      ASSERT_NEAR(hit->distance, *truth, 1e-8);
      ASSERT_NEAR((Vec3(hit->normal) - (Vec3(hit->point) - centre) / kRadius).length(), 0, 1e-5);
    }
  }
  EXPECT_GT(hits, 9000);
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

FieldPtr randomSolid(Numbers& numbers, int depth) {
  const auto point = [&] { return numbers.point(0.8); };
  if (depth == 0) {
    const double size = numbers.uniform(0.2, 0.6);
    switch (static_cast<int>(numbers.uniform(0, 5))) {
      case 0:
        return implicit::makeBox(point(), Vec3(size, 0.4, 0.7 - size), 0);
      case 1:
        return implicit::makeCylinder(point(), point() + Vec3(0, 0, 2), size);
      case 2:
        return implicit::makeSegment(point(), point(), size / 2);
      case 3:
        return implicit::makeQuadric({1, 2, -1, 0.3, 0, 0.2, 0, 0, size, -size});
      default:
        return implicit::makeSphere(point(), size);
    }
  }
  const auto operation =
      depth % 2 == 0 ? implicit::Operation::Union : implicit::Operation::Intersection;
  FieldPtr a = randomSolid(numbers, depth - 1);
  FieldPtr b = randomSolid(numbers, depth - 1);
  if (operation == implicit::Operation::Intersection) b = implicit::makeComplement(b);
  implicit::Affine map;
  map.rows = {Vec3(0.8, 0.6, 0), Vec3(-0.5, 0.9, 0.1), Vec3(0, 0.2, 1.1)};
  map.shift = point() * 0.2;
  return implicit::transformed(
      implicit::combine(operation, {std::move(a), std::move(b), randomSolid(numbers, 0)}, 0), map);
}

TEST(FieldRays, ByRootsAndByBoundsMeetTheSame) {
  Numbers numbers;
  int hits = 0;
  for (int n = 0; n < 10; ++n) {
    const FieldPtr solid =
        implicit::combine(implicit::Operation::Intersection,
                          {randomSolid(numbers, 3), implicit::makeBox({0, 0, 0}, Vec3(1.5), 0)}, 0);
    const auto byRoots = makeRaySurface(solid);
    const auto byBounds = makeRaySurface(std::make_shared<Searched>(solid));
    for (int k = 0; k < 300; ++k) {
      // From inside as well, and along axes.
      const Vec3 from = numbers.point(k % 3 == 0 ? 1 : 3);
      const Vec3 direction =
          k % 5 == 0 ? Vec3(0, 0, from[2] > 0 ? -1 : 1) : numbers.point(1) - from;
      const auto one = castRay(*byRoots, {from, direction});
      const auto other = castRay(*byBounds, {from, direction});
      ASSERT_EQ(one.has_value(), other.has_value()) << n << " " << k;
      if (!one) continue;
      ++hits;
      ASSERT_NEAR(one->distance, other->distance, 1e-9) << n << " " << k;
    }
  }
  EXPECT_GT(hits, 500);
}

/// Solids with faces in common have neither a gap nor a skin between them.
TEST(FieldRays, CommonFacesAreNoSurface) {
  Numbers numbers;
  const FieldPtr left = implicit::makeBox({-0.35, 0.1, 0.2}, {0.35, 0.7, 0.9}, 0);
  const FieldPtr right = implicit::makeBox({0.3, 0.1, 0.2}, {0.3, 0.7, 0.9}, 0);
  const auto both = makeRaySurface(implicit::combine(implicit::Operation::Union, {left, right}, 0));
  const auto neither = makeRaySurface(implicit::combine(implicit::Operation::Intersection,
                                                        {left, implicit::makeComplement(left)}, 0));
  for (int n = 0; n < 2000; ++n) {
    const Vec3 from(-0.5, numbers.uniform(-0.1, 0.3), numbers.uniform(0, 0.4));
    const Vec3 to(0.6, numbers.uniform(-0.1, 0.3), numbers.uniform(0, 0.4));
    const auto hit = castRay(*both, {from, to - from});
    ASSERT_TRUE(hit);
    ASSERT_NEAR(hit->point.x, 0.6, 1e-12) << n;
    ASSERT_FALSE(castRay(*neither, {from - Vec3(3, 0, 0), to - from})) << n;
  }
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
