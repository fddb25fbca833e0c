// Marching cubes on the dual grid of an octree. What all methods promise is tested with the others.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/extract.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cmath>
#include <string>

#include "support/expect_error.h"
#include "support/fields.h"
#include "support/mesh_oracle.h"
#include "support/shape.h"

namespace tufa {
namespace {

using openvdb::CoordBBox;
using openvdb::FloatGrid;

Mesh octree(const openvdb::GridBase& grid, double tolerance, Ambiguity rule = Ambiguity::Separate) {
  ExtractOptions options;
  options.contour.tolerance = tolerance;
  options.contour.ambiguity = rule;
  return extract(grid, Method::OctreeCubes, options);
}

void expectClosed(const Mesh& mesh, const std::string& what) {
  const test::MeshTopology topology = test::inspect(mesh);
  EXPECT_TRUE(topology.manifold()) << what << ": " << topology;
  EXPECT_EQ(topology.boundaryEdges, 0U) << what << ": " << topology;
  EXPECT_EQ(topology.misorientedEdges, 0U) << what << ": " << topology;
}

TEST(OctreeCubes, AreMarchingCubesWithoutTolerance) {
  const auto grid = test::shapeOf(Shape::Bracket, 0.05);
  for (const Ambiguity rule : {Ambiguity::Separate, Ambiguity::Asymptotic}) {
    ExtractOptions options;
    options.contour.ambiguity = rule;
    EXPECT_TRUE(
        test::sameBytes(octree(*grid, 0, rule), extract(*grid, Method::MarchingCubes, options)));
  }
}

TEST(OctreeCubes, AreClosedAtAnyTolerance) {
  for (const Shape which : {Shape::Bracket, Shape::Gyroid, Shape::Fog, Shape::Terrain}) {
    const auto grid = test::shapeOf(which, 0.04);
    for (const double tolerance : {0.1, 0.5, 5.0}) {
      expectClosed(octree(*grid, tolerance, Ambiguity::Asymptotic),
                   std::to_string(static_cast<int>(which)) + " at " + std::to_string(tolerance));
    }
  }
}

TEST(OctreeCubes, AreFewerAndWithinTheTolerance) {
  const auto ball = test::shapeOf(Shape::Sphere, 0.02);
  const std::size_t cubes = extract(*ball, Method::MarchingCubes).triangleCount();
  double factor = 3;
  for (const double tolerance : {0.1, 0.5}) {
    const Mesh mesh = octree(*ball, tolerance);
    EXPECT_LT(static_cast<double>(mesh.triangleCount()) * factor, static_cast<double>(cubes));
    factor = 6;
    double most = 0;
    for (const Triangle& triangle : mesh.triangles) {
      double x = 0, y = 0, z = 0;
      for (const VertexIndex v : triangle.vertices) {
        const Position& p = mesh.positions[v];
        most = std::max(most, std::abs(std::hypot(p.x, p.y, p.z) - 1) / 0.02);
        x += p.x / 3, y += p.y / 3, z += p.z / 3;
      }
      most = std::max(most, std::abs(std::hypot(x, y, z) - 1) / 0.02);
    }
    EXPECT_LT(most, tolerance);
    EXPECT_GT(most, 0.1 * tolerance);
  }
}

TEST(OctreeCubes, RefuseAToleranceThatIsNone) {
  const auto ball = test::shapeOf(Shape::Sphere, 0.2);
  for (const double tolerance : {-0.1, std::nan("")}) {
    test::expectError(ErrorCode::InvalidArgument, "tolerance",
                      [&] { (void)octree(*ball, tolerance); });
  }
}

TEST(OctreeCubes, OfAPlaneInADenseFieldHaveTheLargestLeaves) {
  // Not in a band: leaves of up to 8 samples in the middle, where a cube has a 64th of the faces.
  const auto grid = test::sampled<FloatGrid>(
      CoordBBox(openvdb::Coord(-32), openvdb::Coord(31)), 100,
      [](const openvdb::Coord& at) { return std::abs(at.z() - 0.3) - 12 + 0.01 * at.x(); });
  ExtractOptions options;
  options.contour.isovalue = 0;
  options.contour.inside = Inside::Below;
  const Mesh plain = extract(*grid, Method::MarchingCubes, options);
  const Mesh mesh = extract(*grid, Method::OctreeCubes, options);
  expectClosed(mesh, "slab");
  const auto inTheMiddle = [](const Mesh& of) {
    return std::count_if(of.triangles.begin(), of.triangles.end(), [&](const Triangle& triangle) {
      const Position& p = of.positions[triangle.vertices[0]];
      return std::abs(p.x) < 16 && std::abs(p.y) < 16 && std::abs(p.z) > 10;
    });
  };
  EXPECT_GT(inTheMiddle(mesh), 50);
  EXPECT_LT(20 * inTheMiddle(mesh), inTheMiddle(plain));
  EXPECT_NEAR(test::volume(mesh), test::volume(plain), 0.02 * test::volume(plain));
}

}  // namespace
}  // namespace tufa
