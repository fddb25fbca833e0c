// Meshes of shapes whose truth is known: topology, area, volume, and how far the surface is off.

#include <gtest/gtest.h>
#include <openvdb/math/Proximity.h>
#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <tufa/extract.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "support/fields.h"
#include "support/mesh_oracle.h"
#include "support/uniform_mesh.h"

namespace tufa {
namespace {

using openvdb::Vec3d;

Mesh meshOf(Shape shape, double voxelSize, ContourReport* report = nullptr) {
  ShapeOptions options;
  options.voxelSize = voxelSize;
  return tufa::test::uniformMesh(*makeShape(shape, options), {}, report);
}

Vec3d toVec3d(const Position& p) { return {p.x, p.y, p.z}; }

/// Distances in voxels, sorted.
class Errors {
 public:
  explicit Errors(std::vector<double> values) : values_(std::move(values)) {
    std::sort(values_.begin(), values_.end());
  }
  [[nodiscard]] double largest() const { return values_.back(); }
  [[nodiscard]] double quantile(double share) const {
    return values_[static_cast<std::size_t>(share * static_cast<double>(values_.size() - 1))];
  }
  [[nodiscard]] std::size_t count() const { return values_.size(); }

 private:
  std::vector<double> values_;
};

/// How far points of the mesh are from the true shape: the vertices, and on each triangle its
/// middle and the middles of its edges.
Errors meshToShape(const Mesh& mesh, Shape shape, double voxelSize) {
  std::vector<double> errors;
  const auto add = [&](const Vec3d& p) {
    errors.push_back(std::abs(shapeDistance(shape, {p[0], p[1], p[2]})) / voxelSize);
  };
  for (const Position& p : mesh.positions) add(toVec3d(p));
  for (const Triangle& t : triangulate(mesh)) {
    const Vec3d a = toVec3d(mesh.positions[t.vertices[0]]);
    const Vec3d b = toVec3d(mesh.positions[t.vertices[1]]);
    const Vec3d c = toVec3d(mesh.positions[t.vertices[2]]);
    add((a + b + c) / 3);
    add((a + b) / 2);
    add((b + c) / 2);
    add((c + a) / 2);
  }
  return Errors(std::move(errors));
}

double distanceToTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Vec3d weights;
  return (openvdb::math::closestPointOnTriangleToPoint(a, b, c, p, weights) - p).length();
}

/// How far points along the true creases are from the mesh, by a lattice of buckets of triangles.
Errors creasesToMesh(const Mesh& mesh, Shape shape, double voxelSize) {
  const double bucket = 2 * voxelSize;
  const auto bucketOf = [&](const Vec3d& p) {
    return openvdb::Coord(static_cast<int>(std::floor(p[0] / bucket)),
                          static_cast<int>(std::floor(p[1] / bucket)),
                          static_cast<int>(std::floor(p[2] / bucket)));
  };
  const std::vector<Triangle> triangles = triangulate(mesh);
  std::map<openvdb::Coord, std::vector<std::size_t>> buckets;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    openvdb::BBoxd box;
    for (const VertexIndex v : triangles[t].vertices) box.expand(toVec3d(mesh.positions[v]));
    const openvdb::CoordBBox range(bucketOf(box.min()), bucketOf(box.max()));
    for (auto at = range.begin(); at; ++at) buckets[*at].push_back(t);
  }
  std::vector<double> errors;
  for (const Position& point : shapeCreasePoints(shape, voxelSize / 3)) {
    const Vec3d p = toVec3d(point);
    double nearest = bucket;  // farther than the buckets around reach is far enough to fail
    const openvdb::Coord middle = bucketOf(p);
    const openvdb::CoordBBox around(middle.offsetBy(-1), middle.offsetBy(1));
    for (auto at = around.begin(); at; ++at) {
      const auto found = buckets.find(*at);
      if (found == buckets.end()) continue;
      for (const std::size_t t : found->second) {
        const auto& v = triangles[t].vertices;
        nearest = std::min(nearest, distanceToTriangle(p, toVec3d(mesh.positions[v[0]]),
                                                       toVec3d(mesh.positions[v[1]]),
                                                       toVec3d(mesh.positions[v[2]])));
      }
    }
    errors.push_back(nearest / voxelSize);
  }
  return Errors(std::move(errors));
}

TEST(ShapeTopology, IsThatOfTheShape) {
  const struct {
    Shape shape;
    long long euler;
    std::size_t components;
  } expected[] = {{Shape::Sphere, 2, 1}, {Shape::Torus, 0, 1}, {Shape::Box, 2, 1}};
  for (const auto& [shape, euler, components] : expected) {
    for (const double voxelSize : {0.1, 0.04, 0.0173}) {
      const test::MeshTopology topology = test::inspect(meshOf(shape, voxelSize));
      EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
      EXPECT_EQ(topology.euler(), euler);
      EXPECT_EQ(topology.components, components);
    }
  }
  // Six through holes, one of them through the rib.
  const test::MeshTopology bracket = test::inspect(meshOf(Shape::Bracket, 0.02));
  EXPECT_TRUE(bracket.manifold() && bracket.closed()) << bracket;
  EXPECT_EQ(bracket.euler(), 2 - 2 * 6);
}

/// Euler characteristic of a gyroid labyrinth of periods^3 cubic cells, cut out of its lattice.
long long eulerOfGyroid(int periods) {
  constexpr int kPeriod = 16;
  const openvdb::CoordBBox box(openvdb::Coord(0), openvdb::Coord(kPeriod * periods - 1));
  const auto grid = test::sampled<openvdb::FloatGrid>(box, 1, [](const openvdb::Coord& at) {
    const Vec3d p = (at.asVec3d() + Vec3d(0.37)) * (2 * std::numbers::pi / kPeriod);
    return std::sin(p[0]) * std::cos(p[1]) + std::sin(p[1]) * std::cos(p[2]) +
           std::sin(p[2]) * std::cos(p[0]);
  });
  ContourOptions options;
  options.isovalue = 0;
  const test::MeshTopology topology = test::inspect(tufa::test::uniformMesh(*grid, options));
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  return topology.euler();
}

/// A gyroid has Euler characteristic -8 a cubic cell. What the cut adds grows with the faces, edges
/// and corners of the block, so the third difference knows the cells alone.
TEST(ShapeTopology, OfAGyroidGrowsByItsCells) {
  const long long third =
      eulerOfGyroid(4) - 3 * eulerOfGyroid(3) + 3 * eulerOfGyroid(2) - eulerOfGyroid(1);
  EXPECT_EQ(third, 6 * -8);
}

/// Counts that a change may only move on purpose. Euler characteristics follow from the shapes.
TEST(ShapeSummaries, AreThoseOfBefore) {
  const struct {
    Shape shape;
    double voxelSize;
    std::size_t vertices, quads;
    long long euler;
  } expected[] = {
      {Shape::Sphere, 0.05, 7472, 7470, 2},        {Shape::Torus, 0.05, 8384, 8384, 0},
      {Shape::Box, 0.05, 7220, 7218, 2},           {Shape::Bracket, 0.03, 15474, 15484, -10},
      {Shape::Gyroid, 0.04, 49512, 49998, -486},   {Shape::Terrain, 0.05, 6404, 6402, 2},
      {Shape::Noise, 0.0625, 48748, 50534, -1786}, {Shape::Fog, 0.05, 4004, 3988, 16},
  };
  for (const auto& golden : expected) {
    const Mesh mesh = meshOf(golden.shape, golden.voxelSize);
    const test::MeshTopology topology = test::inspect(mesh);
    const auto name = shapeNames()[static_cast<std::size_t>(golden.shape)];
    EXPECT_EQ(topology.vertices, golden.vertices) << name;
    EXPECT_EQ(mesh.quads.size(), golden.quads) << name;
    EXPECT_EQ(topology.euler(), golden.euler) << name;
    EXPECT_TRUE(topology.manifold() && topology.closed()) << name << " " << topology;
  }
}

TEST(ShapeMeasures, ConvergeToTheTruth) {
  const double pi = std::numbers::pi;
  const struct {
    Shape shape;
    double area, volume;
  } expected[] = {{Shape::Sphere, 4 * pi, 4 * pi / 3},
                  {Shape::Torus, 4 * pi * pi * 0.35, 2 * pi * pi * 0.35 * 0.35},
                  {Shape::Box, 8 * (0.9 * 0.7 + 0.7 * 0.5 + 0.5 * 0.9), 8 * 0.9 * 0.7 * 0.5}};
  for (const auto& [shape, area, volume] : expected) {
    for (const double voxelSize : {0.05, 0.02, 0.01}) {
      const Mesh mesh = meshOf(shape, voxelSize);
      const double squared = voxelSize * voxelSize;
      // The chords of a curve of radius r cut off about (size / r)^2 / 8 of it.
      EXPECT_NEAR(test::area(mesh) / area, 1, 4 * squared) << voxelSize;
      EXPECT_NEAR(test::volume(mesh) / volume, 1, 6 * squared) << voxelSize;
    }
  }
}

TEST(ShapeAccuracy, OfSmoothShapesIsWithinAFiftiethOfAVoxel) {
  for (const Shape shape : {Shape::Sphere, Shape::Torus}) {
    // The least radius of curvature is 50 voxels.
    const double voxelSize = (shape == Shape::Sphere ? 1 : 0.35) / 50;
    const Errors errors = meshToShape(meshOf(shape, voxelSize), shape, voxelSize);
    EXPECT_LT(errors.largest(), 0.02);
  }
}

TEST(ShapeAccuracy, OfSharpShapesIsWithinATenthOfAVoxel) {
  const double voxelSize = 0.01;
  for (const Shape shape : {Shape::Box, Shape::Bracket}) {
    ContourReport report;
    const Mesh mesh = meshOf(shape, voxelSize, &report);
    EXPECT_TRUE(report.distanceField);
    EXPECT_GT(report.creaseCells, 500U);
    const Errors surface = meshToShape(mesh, shape, voxelSize);
    EXPECT_LT(surface.quantile(0.999), 0.1);
    EXPECT_LT(surface.largest(), 0.25);
    const Errors creases = creasesToMesh(mesh, shape, voxelSize);
    EXPECT_GT(creases.count(), 2000U);
    EXPECT_LT(creases.quantile(0.999), 0.1);
    EXPECT_LT(creases.largest(), 0.25);
    RecordProperty("surface_largest", std::to_string(surface.largest()));
    RecordProperty("creases_largest", std::to_string(creases.largest()));
  }
}

TEST(ShapeAccuracy, OfSharpMethodsIsBetweenThatOfDualAndOfPlainCubes) {
  const double voxelSize = 0.01;
  for (const Shape shape : {Shape::Box, Shape::Bracket}) {
    ShapeOptions options;
    options.voxelSize = voxelSize;
    const auto grid = makeShape(shape, options);
    const Errors plain = creasesToMesh(extract(*grid, Method::MarchingCubes), shape, voxelSize);
    for (const Method method : {Method::ExtendedMarchingCubes, Method::CubicalMarchingSquares}) {
      ContourReport report;
      const Mesh mesh = extract(*grid, method, {}, &report);
      EXPECT_GT(report.creaseCells, 500U);
      const Errors creases = creasesToMesh(mesh, shape, voxelSize);
      EXPECT_LT(creases.quantile(0.99), 0.15);
      EXPECT_LT(creases.quantile(0.9), 0.05);
      EXPECT_GT(plain.quantile(0.99), 3 * creases.quantile(0.99));
    }
  }
}

}  // namespace
}  // namespace tufa
