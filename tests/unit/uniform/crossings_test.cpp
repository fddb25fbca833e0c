#include "uniform/crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/block_field.h"
#include "support/print.h"

namespace tufa::uniform {
namespace {

using grid::BlockSamples;
using test::BlockField;
using test::distanceAroundBlock;

/// A crossing with the edge it lies on.
struct Found {
  Vec3 start;
  int axis = 0;
  Crossing crossing;
  double linear = 0;  ///< where linear interpolation puts it
  [[nodiscard]] Vec3 point() const {
    Vec3 at = start;
    at[axis] += static_cast<double>(crossing.along);
    return at;
  }
  [[nodiscard]] Vec3 normal() const {
    const auto& n = crossing.normal;
    return {n[0], n[1], n[2]};
  }
};

template <int axis>
void addCrossings(const BlockField& field, std::vector<Found>& found) {
  const CrossingFinder finder(field.samples(), field.scale());
  const auto& samples = field.samples();
  for (int cell = 0; cell < 512; ++cell) {
    const int x = cell >> 6, y = (cell >> 3) & 7, z = cell & 7;
    const int lower = BlockSamples::index(x, y, z);
    const float a = samples[lower], b = samples[lower + BlockSamples::stride(axis)];
    if ((a < 0) == (b < 0)) continue;
    found.push_back({Vec3(x, y, z), axis, finder.at<axis>(lower), a / static_cast<double>(a - b)});
  }
}

std::vector<Found> crossingsOf(const BlockField& field) {
  std::vector<Found> found;
  addCrossings<0>(field, found);
  addCrossings<1>(field, found);
  addCrossings<2>(field, found);
  return found;
}

/// Where a function changes sign on an edge, by bisection.
template <class Function>
double rootOn(const Found& edge, const Function& distance) {
  const auto at = [&](double along) {
    Vec3 p = edge.start;
    p[edge.axis] += along;
    return distance(p) < 0;
  };
  double low = 0, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (at(middle) == at(0) ? low : high) = middle;
  }
  return low;
}

TEST(Crossings, OfAPlaneAreExact) {
  for (const Vec3& direction : {Vec3(1, 2, 3), Vec3(-3, 1, 0.2), Vec3(0, 0, 1), Vec3(1, -1, 1)}) {
    const test::PlaneDistance plane{direction.unitOrX(),
                                    direction.unitOrX().dot(Vec3(4.2, 3.7, 3.9))};
    const auto field = distanceAroundBlock(plane);
    const auto found = crossingsOf(field);
    EXPECT_GE(found.size(), 64U);
    for (const Found& f : found) {
      EXPECT_NEAR(plane(f.point()), 0, 1e-5);
      EXPECT_LT((f.normal() - plane.normal).length(), 1e-5);
      EXPECT_EQ(f.crossing.kink, Kink::None);
    }
  }
}

TEST(Crossings, OfASphereAreWithinItsCurvature) {
  const double radius = 30;
  const Vec3 center = Vec3(4) - Vec3(1, 0.7, 0.4).unitOrX() * radius;
  const auto distance = [&](const Vec3& p) { return (p - center).length() - radius; };
  const auto field = distanceAroundBlock(distance);
  for (const Found& f : crossingsOf(field)) {
    EXPECT_LT(std::abs(distance(f.point())), 1 / (8 * radius) * 1.1);
    EXPECT_LT((f.normal() - (f.point() - center).unitOrX()).length(), 2e-3);
    EXPECT_NEAR(uniform::dot(f.crossing.normal, f.crossing.normal), 1, 1e-5);
  }
}

TEST(Crossings, BesideCreasesComeFromOneSide) {
  const test::TurnedBoxDistance box = test::boxWithCornerInBlock();
  const auto field = distanceAroundBlock(box);
  ASSERT_TRUE(field.scale().distance);
  double worst = 0, sum = 0, linearSum = 0;
  int offSide = 0, creases = 0;
  const auto found = crossingsOf(field);
  for (const Found& f : found) {
    const double truth = rootOn(f, box);
    const double error = std::abs(static_cast<double>(f.crossing.along) - truth);
    worst = std::max(worst, error);
    sum += error;
    linearSum += std::abs(f.linear - truth);
    creases += f.crossing.kink != Kink::None ? 1 : 0;
    offSide += box.cosineToAxis(f.normal()) < 0.99 ? 1 : 0;
  }
  EXPECT_GT(creases, 20);
  EXPECT_LT(worst, 0.2);
  EXPECT_LT(sum, 0.35 * linearSum);
  EXPECT_LT(offSide, static_cast<int>(found.size()) / 10);
}

/// The kinks at the crossings of a convex roof whose two sides are so many degrees apart.
std::vector<Kink> kinksOfRoof(double degrees) {
  const double half = degrees / 2 * 3.14159265358979 / 180;
  const Vec3 up = Vec3(1, 2, 3).unitOrX(), along = up.cross(Vec3(1, 0, 0)).unitOrX();
  const Vec3 across = along.cross(up);
  const Vec3 left = up * std::cos(half) + across * std::sin(half);
  const Vec3 right = up * std::cos(half) - across * std::sin(half);
  const Vec3 ridge(4.2, 3.7, 3.9);
  const auto field = distanceAroundBlock([&](const Vec3& p) {
    const double a = left.dot(p - ridge), b = right.dot(p - ridge);
    // Beyond both sides, seen from the ridge, the ridge is nearest.
    const Vec3 foot = ridge + along * along.dot(p - ridge);
    const bool beyond = across.dot(p - foot) * std::cos(half) < std::sin(half) * up.dot(p - foot) &&
                        across.dot(p - foot) * std::cos(half) > -std::sin(half) * up.dot(p - foot);
    return beyond ? (p - foot).length() : std::max(a, b);
  });
  std::vector<Kink> kinks;
  for (const Found& f : crossingsOf(field)) kinks.push_back(f.crossing.kink);
  return kinks;
}

TEST(Crossings, TellSharpKinksFromGentleOnes) {
  const auto count = [](const std::vector<Kink>& kinks, Kink kink) {
    return std::count(kinks.begin(), kinks.end(), kink);
  };
  const std::vector<Kink> gentle = kinksOfRoof(25), sharp = kinksOfRoof(90);
  EXPECT_GT(count(gentle, Kink::Gentle), 5);
  EXPECT_EQ(count(gentle, Kink::Sharp), 0);
  EXPECT_GT(count(sharp, Kink::Sharp), 5);
}

template <int axis>
void expectBatchesAgree(const BlockField& field) {
  const CrossingFinder finder(field.samples(), field.scale());
  std::vector<Found> found;
  addCrossings<axis>(field, found);
  ASSERT_GE(found.size(), static_cast<std::size_t>(CrossingBatch::kSize));
  for (std::size_t first = 0; first + CrossingBatch::kSize <= found.size(); ++first) {
    CrossingBatch batch;
    for (std::size_t lane = 0; lane < CrossingBatch::kSize; ++lane) {
      const Vec3& p = found[first + lane].start;
      batch.lower[lane] = static_cast<std::uint16_t>(BlockSamples::index(
          static_cast<int>(p[0]), static_cast<int>(p[1]), static_cast<int>(p[2])));
    }
    finder.findAll<axis>(batch);
    for (std::size_t lane = 0; lane < CrossingBatch::kSize; ++lane) {
      const Crossing& one = found[first + lane].crossing;
      ASSERT_EQ(batch.along[lane], one.along);
      for (int i = 0; i < 3; ++i) ASSERT_EQ(batch.normals[i][lane], one.normal[i]);
      ASSERT_EQ(batch.kinks[lane], one.kink);
    }
  }
}

TEST(Crossings, InBatchesAreThoseFoundOneByOne) {
  const auto field = distanceAroundBlock(test::boxWithCornerInBlock());
  expectBatchesAgree<0>(field);
  expectBatchesAgree<1>(field);
  expectBatchesAgree<2>(field);
}

TEST(Crossings, OfADensityAreNeverCreases) {
  const test::TurnedBoxDistance box = test::boxWithCornerInBlock();
  auto grid =
      test::sampled<openvdb::FloatGrid>(test::boxAroundBlock(), 0, [&](const openvdb::Coord& at) {
        return std::clamp(-box(Vec3(grid::fromVdb(at))), -3.0, 3.0);
      });
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  const BlockField field(grid, {.isovalue = 0, .insideIsBelow = false});
  const auto found = crossingsOf(field);
  ASSERT_GT(found.size(), 64U);
  for (const Found& f : found) {
    EXPECT_EQ(f.crossing.kink, Kink::None);
    EXPECT_NEAR(static_cast<double>(f.crossing.along), std::clamp(f.linear, 1e-3, 1 - 1e-3), 1e-5);
    // Outward is where the density falls.
    EXPECT_GT(f.normal().dot(f.point() - box.center), 0);
  }
}

TEST(Crossings, OnASampleStayOffTheEndOfTheirEdge) {
  const test::PlaneDistance plane{Vec3(0, 0, 1), 3};
  const auto field = distanceAroundBlock(plane);
  const auto found = crossingsOf(field);
  ASSERT_EQ(found.size(), 64U);
  for (const Found& f : found) {
    EXPECT_EQ(f.start[2], 2);  // the sample on the isovalue is outside
    EXPECT_FLOAT_EQ(f.crossing.along, 1 - 1e-3F);
  }
}

TEST(Crossings, WithoutGradientLookAlongTheirEdge) {
  // Both samples beside the one inside are equal, so central differences vanish.
  auto grid = test::sampled<openvdb::FloatGrid>(
      test::boxAroundBlock(), 1, [](const openvdb::Coord& at) { return at.z() % 2 == 0 ? 1 : -1; });
  const BlockField field(grid);
  for (const Found& f : crossingsOf(field)) {
    const bool rising = static_cast<int>(f.start[2]) % 2 != 0;
    EXPECT_EQ(f.normal(), Vec3(0, 0, rising ? 1 : -1));
    EXPECT_EQ(f.crossing.along, 0.5F);
  }
}

}  // namespace
}  // namespace tufa::uniform
