#include "refine/local_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace tufa::refine {
namespace {

constexpr double kVoxel = 0.25;

// Random points in balls of 40 voxels about some places, given in voxels.
std::vector<Position> cloudsAt(const std::vector<Vec3>& places) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(-40, 40);
  std::vector<Position> points;
  for (const Vec3& place : places) {
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = (place + Vec3(offset(random), offset(random), offset(random))) * kVoxel;
      points.push_back({p[0], p[1], p[2]});
    }
  }
  return points;
}

double largestComponent(const base::Vec3f& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

LocalFrame frameOf(const std::vector<Position>& points) {
  base::Job job(1, {});
  return {points, kVoxel, job};
}

TEST(LocalFrame, CountsVoxelsFromTheMiddle) {
  const auto points = cloudsAt({{1e6, -2e5, 7}});
  const LocalFrame frame = frameOf(points);
  EXPECT_EQ(frame.rounding(), 0);
  EXPECT_EQ(frame.within(3), 3);
  EXPECT_NEAR(frame.size(), 80 * std::sqrt(3.0), 2);
  for (const Position& p : points) {
    EXPECT_LT(largestComponent(frame.toLocal(p)), 41);
    EXPECT_LT((Vec3(frame.toExact(frame.toLocal(p))) - Vec3(p)).length(), 1e-5 * kVoxel);
  }
}

// Stray particles: what lies between is taken out, and each piece stays what it is.
TEST(LocalFrame, TakesOutWhatIsEmpty) {
  for (const double far : {2e4, 5e5, 1e9}) {
    const std::vector<Vec3> places = {{0, 0, 0}, {far, 0, 100}, {-far, 2 * far, 0}, {90, far, 0}};
    const auto points = cloudsAt(places);
    const LocalFrame frame = frameOf(points);
    EXPECT_LT(frame.rounding(), 2e-3) << far;
    EXPECT_EQ(frame.within(1e6), 1024 - frame.rounding()) << far;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const base::Vec3f local = frame.toLocal(points[i]);
      EXPECT_LT(largestComponent(local), 16000);
      EXPECT_LT((Vec3(frame.toExact(local)) - Vec3(points[i])).length(),
                (frame.rounding() + 1e-3 + far * 1e-14) * kVoxel);
      const std::size_t first = i / 500 * 500;
      const Vec3 within = (Vec3(points[i]) - Vec3(points[first])) * (1 / kVoxel);
      const base::Vec3f moved = local - frame.toLocal(points[first]);
      EXPECT_LT((Vec3(moved) - within).length(), 4e-3);
      // Other pieces stay far away, even if both moved towards each other as far as they may.
      const std::size_t other = (i + 500) % points.size();
      EXPECT_GT(base::length(local - frame.toLocal(points[other])), 2 * 1024 + 100);
    }
  }
}

// As the points of a long wire have no empty space between them.
TEST(LocalFrame, TellsOfRoundingInALargeMesh) {
  const auto wireOf = [](double length) {
    std::vector<Position> points;
    for (double x = -length / 2; x <= length / 2; x += 100) points.push_back({x * kVoxel, 0, 0});
    return points;
  };
  EXPECT_EQ(frameOf(wireOf(8000)).rounding(), 0);
  const LocalFrame large = frameOf(wireOf(100000));
  EXPECT_NEAR(large.rounding(), std::sqrt(3.0) / 256, 1e-9);  // the last digit of 50,000
  EXPECT_EQ(large.within(0.1), 0.1 - large.rounding());
  EXPECT_EQ(large.within(1e-3), 0);
  EXPECT_EQ(frameOf(wireOf(600000)).within(10), 0);
}

}  // namespace
}  // namespace tufa::refine
