#include "distance/reference.h"

#include <gtest/gtest.h>
#include <openvdb/math/Proximity.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "support/model.h"
#include "support/print.h"

namespace tufa::distance {
namespace {

double toTriangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  openvdb::Vec3d weights;
  const auto foot = openvdb::math::closestPointOnTriangleToPoint(
      grid::toVdb(a), grid::toVdb(b), grid::toVdb(c), grid::toVdb(point), weights);
  return (grid::fromVdb(foot) - point).length();
}

double toQuad(const Mesh& mesh, const Quad& quad, const Vec3& point) {
  const auto p = [&](int i) { return Vec3(mesh.positions[quad.vertices[i]]); };
  return std::min(toTriangle(point, p(0), p(1), p(2)), toTriangle(point, p(0), p(2), p(3)));
}

double toMesh(const Mesh& mesh, const Vec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const Quad& quad : mesh.quads) least = std::min(least, toQuad(mesh, quad, point));
  return least;
}

constexpr double kVoxel = 0.5;

// Positions are counted from the lowest block.
Vec3 worldOrigin(const test::ModelOf& model) {
  return Vec3(model.model().affine().fromWorld(Position(0, 0, 0)));
}

TEST(Reference, TellsTheDistanceToTheUniformMesh) {
  const test::ModelOf model(test::ballOf(10.3, kVoxel));
  std::mt19937 random(1);
  std::normal_distribution<double> number;
  std::uniform_real_distribution<double> off(-1.5, 1.5);
  for (int i = 0; i < 300; ++i) {
    const Vec3 outward = Vec3(number(random), number(random), number(random)).unitOrX();
    const Vec3 point = worldOrigin(model) + outward * ((10.3 + off(random)) * kVoxel);
    const double found = model.model().reference().distance(point, outward, 4, 0);
    EXPECT_NEAR(found, toMesh(model.mesh(), point), 1e-9) << outward;
  }
}

TEST(Reference, IsNeverTooSmallWhenAnyAnswerIsEnough) {
  const test::ModelOf model(test::ballOf(10.3, kVoxel));
  std::mt19937 random(2);
  std::normal_distribution<double> number;
  for (int i = 0; i < 100; ++i) {
    const Vec3 outward = Vec3(number(random), number(random), number(random)).unitOrX();
    const Vec3 point = worldOrigin(model) + outward * (10.6 * kVoxel);
    const double enough = kVoxel;
    const double found = model.model().reference().distance(point, outward, 4, enough);
    EXPECT_GE(found, toMesh(model.mesh(), point) - 1e-9);
    EXPECT_LE(found, enough);
  }
}

TEST(Reference, IsInfiniteWhereNoVertexIsInReach) {
  const test::ModelOf model(test::ballOf(10.3, kVoxel));
  const Vec3 middle = worldOrigin(model);
  EXPECT_TRUE(std::isinf(model.model().reference().distance(middle, Vec3(0, 0, 1), 4, 0)));
  EXPECT_NEAR(model.model().reference().distance(middle, Vec3(0, 0, 1), 12, 0),
              toMesh(model.mesh(), middle), 0.5 * kVoxel);
  EXPECT_TRUE(std::isinf(
      model.model().reference().distance(middle + Vec3(1000, 0, 0), Vec3(1, 0, 0), 12, 0)));
}

// A slab from z = -1.2 to z = 1.2, its rim far away.
TEST(Reference, LooksForTheSheetThatFacesAsThePointDoes) {
  const test::ModelOf model(test::levelSetOf(20, kVoxel, [](const Vec3& p) {
    return std::max({std::abs(p[0]) - 14, std::abs(p[1]) - 14, std::abs(p[2]) - 1.2});
  }));
  const Vec3 point = worldOrigin(model) + Vec3(0.3, 0.2, -0.2) * kVoxel;
  const auto& reference = model.model().reference();
  EXPECT_NEAR(reference.distance(point, Vec3(0, 0, 1), 4, 0), 1.4 * kVoxel, 1e-3);
  EXPECT_NEAR(reference.distance(point, Vec3(0, 0, -1), 4, 0), 1.0 * kVoxel, 1e-3);
}

TEST(Reference, MeasuresToOneQuad) {
  const test::ModelOf model(test::ballOf(6.3, kVoxel));
  const Mesh& mesh = model.mesh();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 20 * kVoxel);
  for (int i = 0; i < 500; ++i) {
    const std::size_t quad = random() % mesh.quads.size();
    const Vec3 point(place(random), place(random), place(random));
    EXPECT_NEAR(model.model().reference().distanceToQuad(point, quad),
                toQuad(mesh, mesh.quads[quad], point), 1e-9);
  }
}

}  // namespace
}  // namespace tufa::distance
