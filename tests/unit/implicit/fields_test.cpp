// Every kind of field against what defines its parts: central differences, random samples.

#include <gtest/gtest.h>
#include <tufa/implicit.h>

#include <cmath>
#include <random>

#include "implicit/boxes.h"
#include "implicit/fields.h"
#include "unit/implicit/field_list.h"

namespace tufa {
namespace {

using implicit::Box;
using implicit::Field;
using implicit::Interval;
using test::allFields;

/// Places and boxes that are the same in every run, on every system.
class Places {
 public:
  double uniform(double least, double greatest) {
    constexpr double kMost = 4294967295.0;
    return least + (greatest - least) * static_cast<double>(random_()) / kMost;
  }
  Vec3 point(double reach) {
    const double x = uniform(-reach, reach);
    const double y = uniform(-reach, reach);
    return {x, y, uniform(-reach, reach)};
  }
  Vec3 pointIn(const Box& box) {
    const Vec3 half = implicit::halfOf(box);
    const double x = uniform(-half[0], half[0]);
    const double y = uniform(-half[1], half[1]);
    return implicit::centreOf(box) + Vec3(x, y, uniform(-half[2], half[2]));
  }
  /// Of any size from a thousandth to a unit and a half.
  Box box() {
    const Vec3 centre = point(1.5);
    const double x = std::exp(uniform(-7, 0.4));
    const double y = x * std::exp(uniform(-1, 0));
    return implicit::boxAround(centre, {x, y, x * std::exp(uniform(-1, 0))});
  }

 private:
  std::mt19937 random_{24};
};

Vec3 centralDifference(const Field& field, const Vec3& p, double step) {
  Vec3 slope(0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 reach(0.0);
    reach[axis] = step;
    slope[axis] = (field.value(p + reach) - field.value(p - reach)) / (2 * step);
  }
  return slope;
}

TEST(Fields, GradientsAreCentralDifferences) {
  for (const auto& [name, field] : allFields()) {
    Places places;
    int atCreases = 0;
    constexpr int kPoints = 400;
    for (int n = 0; n < kPoints; ++n) {
      const Vec3 p = places.point(1.5);
      const Vec3 gradient = field->gradient(p);
      const Vec3 coarse = centralDifference(*field, p, 2e-5);
      const Vec3 fine = centralDifference(*field, p, 1e-5);
      const double scale = 1 + coarse.length();
      // Beside a crease the differences do not agree with each other.
      if ((coarse - fine).length() > 1e-6 * scale) {
        ++atCreases;
        continue;
      }
      ASSERT_LT((gradient - fine).length(), 1e-5 * scale) << name << " at " << p[0] << " " << p[1];
    }
    EXPECT_LT(atCreases, kPoints / 20) << name;
  }
}

void expectBoundsHold(const Field& field, const Box& box, int samples, Places& places,
                      const std::string& name) {
  const Interval bound = field.bound(box);
  const double steepest = field.lipschitz(box);
  const Box slopes = field.gradientBound(box);
  ASSERT_LE(bound.least, bound.greatest) << name;
  for (int k = 0; k < samples; ++k) {
    const Vec3 p = places.pointIn(box);
    const double value = field.value(p);
    ASSERT_GE(value, bound.least) << name;
    ASSERT_LE(value, bound.greatest) << name;
    const Vec3 gradient = field.gradient(p);
    ASSERT_LE(gradient.length(), steepest * (1 + 1e-9) + 1e-12) << name;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Interval side = implicit::sideOf(slopes, axis);
      const double room = 1e-9 * (1 + gradient.length());
      ASSERT_GE(gradient[axis], side.least - room) << name;
      ASSERT_LE(gradient[axis], side.greatest + room) << name;
    }
  }
}

/// A million samples of each field.
TEST(Fields, BoundsHoldAllSamples) {
  for (const auto& [name, field] : allFields()) {
    Places places;
    for (int n = 0; n < 8000; ++n) {
      ASSERT_NO_FATAL_FAILURE(expectBoundsHold(*field, places.box(), 60, places, name));
    }
  }
}

/// Where they are not, too much is sampled.
TEST(Fields, BoundsOfSmallBoxesAreTight) {
  for (const auto& [name, field] : allFields()) {
    Places places;
    double worst = 0;
    for (int n = 0; n < 100; ++n) {
      const Vec3 p = places.point(1.4);
      constexpr double kHalf = 1e-4;
      const Interval bound = field->bound(implicit::boxAround(p, Vec3(kHalf)));
      const double range = 2 * std::sqrt(3.0) * kHalf * (Vec3(field->gradient(p)).length() + 0.1);
      worst = std::max(worst, (bound.greatest - bound.least) / range);
    }
    EXPECT_LT(worst, 20) << name;
  }
}

TEST(Fields, AllOfTheInsideLiesInTheExtent) {
  for (const auto& [name, field] : allFields()) {
    Places places;
    const Box extent = field->extent();
    for (int n = 0; n < 4000; ++n) {
      const Vec3 p = places.point(3);
      if (field->value(p) >= 0) continue;
      const Box with = implicit::hull(extent, {p, p});
      ASSERT_EQ(with.least, extent.least) << name;
      ASSERT_EQ(with.greatest, extent.greatest) << name;
    }
  }
}

TEST(Fields, RestrictedOnesHaveTheSameValues) {
  int restrictedOnes = 0;
  for (const auto& [name, field] : allFields()) {
    Places places;
    for (int n = 0; n < 60; ++n) {
      const Box box = places.box();
      const auto restricted = field->restricted(box);
      if (!restricted) continue;
      ++restrictedOnes;
      for (int k = 0; k < 20; ++k) {
        const Vec3 p = places.pointIn(box);
        ASSERT_EQ(restricted->value(p), field->value(p)) << name;
        if (!field->hasUnitGradient()) continue;
        ASSERT_EQ(restricted->distance(p, 1), field->distance(p, 1)) << name;
      }
    }
  }
  EXPECT_GT(restrictedOnes, 100);
}

TEST(Fields, RestrictedOnesHaveBoundsThatHold) {
  for (const auto& [name, field] : allFields()) {
    Places places;
    for (int n = 0; n < 100; ++n) {
      const Box box = places.box();
      const auto restricted = field->restricted(box);
      if (!restricted) continue;
      const Vec3 a = places.pointIn(box);
      const Vec3 b = places.pointIn(box);
      for (const Box& part : {box, Box{minVec3(a, b), maxVec3(a, b)}}) {
        ASSERT_NO_FATAL_FAILURE(expectBoundsHold(*restricted, part, 30, places, name));
      }
    }
  }
}

TEST(Fields, ClosedFormsSayWhichPartsOfLinesAreInside) {
  int closedForms = 0;
  for (const auto& [name, field] : allFields()) {
    Places places;
    std::vector<Interval> spans;
    if (!field->insideAlong({}, -3, 3, spans)) {
      EXPECT_TRUE(spans.empty()) << name;
      continue;
    }
    ++closedForms;
    int ends = 0;
    for (int n = 0; n < 400; ++n) {
      const Vec3 from = places.point(1);
      // Some along an axis, and of any length.
      const Vec3 direction = n % 4 == 0 ? Vec3(0, n % 8 == 0 ? 1 : -0.5, 0) : places.point(1.5);
      spans.assign(1, {7, 8});  // not its own
      ASSERT_TRUE(field->insideAlong({from, direction}, -3, 3, spans)) << name;
      ASSERT_EQ(spans[0].least, 7);
      double last = -implicit::kInfinity;
      for (std::size_t k = 1; k < spans.size(); ++k) {
        ASSERT_TRUE(spans[k].least < spans[k].greatest) << name;
        ASSERT_TRUE(k == 1 || last < spans[k].least) << name;
        last = spans[k].greatest;
      }
      for (double t = -3; t <= 3; t += 0.037) {
        const double value = field->value(from + direction * t);
        bool inside = false;
        double nearest = implicit::kInfinity;
        for (std::size_t k = 1; k < spans.size(); ++k) {
          inside = inside || (spans[k].least < t && t < spans[k].greatest);
          for (const double end : {spans[k].least, spans[k].greatest}) {
            nearest = std::min(nearest, std::abs(t - end));
          }
        }
        if (nearest > 1e-9 && std::abs(value) > 1e-12) {
          ASSERT_EQ(inside, value < 0) << name << " " << n << " " << t;
        }
        if (nearest < 0.037) ++ends;
      }
    }
    EXPECT_GT(ends, 100) << name;
  }
  EXPECT_EQ(closedForms, 16);
}

TEST(Fields, UnitGradientsAreUnitVectors) {
  int fields = 0;
  for (const auto& [name, field] : allFields()) {
    if (!field->hasUnitGradient()) continue;
    ++fields;
    Places places;
    for (int n = 0; n < 100; ++n) {
      const Vec3 p = places.point(1.5);
      ASSERT_NEAR(Vec3(field->gradient(p)).length(), 1, 1e-9) << name;
      ASSERT_NEAR(Vec3(field->normal(p)).length(), 1, 1e-9) << name;
      ASSERT_EQ(field->distance(p, 1), field->value(p)) << name;
    }
  }
  EXPECT_GT(fields, 10);
}

/// No point of the surface is nearer, and one is as near.
TEST(Fields, DistancesAreThoseToTheSurface) {
  const std::vector<std::string> exact = {
      "sphere",   "segment", "circle", "circle of a thick tube", "box", "plane", "round box",
      "cylinder", "turned",  "mesh"};
  for (const auto& [name, field] : allFields()) {
    if (std::find(exact.begin(), exact.end(), name) == exact.end()) continue;
    Places places;
    for (int n = 0; n < 200; ++n) {
      const Vec3 p = places.point(1.5);
      const double distance = field->value(p);
      const Vec3 foot = p - Vec3(field->gradient(p)) * distance;
      ASSERT_NEAR(field->value(foot), 0, 1e-9) << name;
      for (int k = 0; k < 20; ++k) {
        const Vec3 q = places.point(1.5);
        ASSERT_LE(std::abs(distance - field->value(q)), (p - q).length() + 1e-9) << name;
      }
    }
  }
}

/// "The solid goes on" must be said by the bounds of boxes without end, too.
TEST(Fields, BoundsOfEndlessBoxesHold) {
  for (const auto& [name, field] : allFields()) {
    Places places;
    const Interval bound = field->bound(implicit::wholeSpace());
    for (int n = 0; n < 500; ++n) {
      const double value = field->value(places.point(20));
      if (std::isnan(value)) continue;
      ASSERT_GE(value, bound.least) << name;
      ASSERT_LE(value, bound.greatest) << name;
    }
  }
}

TEST(Fields, ASmoothUnionIsWithinAQuarterOfTheRadius) {
  const auto a = implicit::makeSphere({-0.5, 0, 0}, 0.6);
  const auto b = implicit::makeSphere({0.5, 0, 0}, 0.6);
  const auto sharp = implicit::combine(implicit::Operation::Union, {a, b}, 0);
  const auto smooth = implicit::combine(implicit::Operation::Union, {a, b}, 0.4);
  Places places;
  for (int n = 0; n < 1000; ++n) {
    const Vec3 p = places.point(1.5);
    EXPECT_LE(smooth->value(p), sharp->value(p));
    EXPECT_GE(smooth->value(p), sharp->value(p) - 0.1 - 1e-12);
  }
  EXPECT_NEAR(smooth->value({0, 0, 0.3}), sharp->value({0, 0, 0.3}) - 0.1, 1e-12);
}

}  // namespace
}  // namespace tufa
