// Cubical marching squares whose cells are merged into leaves of an octree.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/extract.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "extract/fill_loop.h"
#include "support/expect_error.h"
#include "support/fields.h"
#include "support/mesh_oracle.h"
#include "support/shape.h"

namespace tufa {
namespace {

using openvdb::CoordBBox;
using openvdb::FloatGrid;

Mesh merged(const openvdb::GridBase& grid, ExtractOptions options, double tolerance) {
  options.mergeTolerance = tolerance;
  return extract(grid, Method::CubicalMarchingSquares, options);
}

// Of fields whose surface is where they are 0.
ExtractOptions atZero(double sharpAngle = ExtractOptions().sharpAngle) {
  ExtractOptions options;
  options.contour.isovalue = 0;
  options.contour.inside = Inside::Below;
  options.sharpAngle = sharpAngle;
  return options;
}

void expectClosedManifold(const Mesh& mesh, const std::string& what) {
  const test::MeshTopology topology = test::inspect(mesh);
  EXPECT_TRUE(topology.manifold() && topology.closed()) << what << ": " << topology;
  EXPECT_GT(test::volume(mesh), 0) << what;
}

// Waves without order, a few voxels long, so that leaves of all levels have every topology.
FloatGrid::Ptr waves(double length) {
  return test::sampled<FloatGrid>(
      CoordBBox(openvdb::Coord(-24), openvdb::Coord(23)), 1, [&](const openvdb::Coord& at) {
        const double x = at.x() / length, y = at.y() / length, z = at.z() / length;
        return std::sin(x + 1.3 * y) + std::sin(1.1 * y - z + 1) + std::sin(0.9 * z + 0.7 * x + 2) +
               std::sin(1.7 * x - 0.6 * y + 0.8 * z);
      });
}

// Nothing is lost: what is in a leaf is a disk.
void expectSameTopology(const Mesh& mesh, const Mesh& finest) {
  const test::MeshTopology own = test::inspect(mesh), whole = test::inspect(finest);
  EXPECT_EQ(own.euler(), whole.euler());
  EXPECT_EQ(own.components, whole.components);
}

TEST(MergedCells, GiveClosedManifoldsOfShapesAtAnyTolerance) {
  for (const Shape which : {Shape::Bracket, Shape::Gyroid, Shape::Fog, Shape::Terrain}) {
    const auto grid = test::shapeOf(which, 0.04);
    const Mesh finest = merged(*grid, {}, 0);
    for (const double tolerance : {0.1, 0.5, 5.0}) {
      const Mesh mesh = merged(*grid, {}, tolerance);
      expectClosedManifold(
          mesh, std::to_string(static_cast<int>(which)) + " at " + std::to_string(tolerance));
      expectSameTopology(mesh, finest);
      EXPECT_LE(mesh.triangleCount(), finest.triangleCount());
      EXPECT_TRUE(tolerance < 0.5 || mesh.triangleCount() < finest.triangleCount());
    }
  }
}

TEST(MergedCells, GiveClosedManifoldsOfAnyFieldWhateverIsMerged) {
  // An angle of 180 degrees and a large tolerance merge all cells but where lattice edges along an
  // axis lead both out of the inside and into it.
  for (const std::uint32_t seed : {1U, 2U}) {
    const auto noise = test::noise<FloatGrid>({.size = 20, .seed = seed});
    const Mesh finest = merged(*noise, atZero(180), 0);
    for (const double tolerance : {0.5, 1000.0}) {
      const Mesh mesh = merged(*noise, atZero(180), tolerance);
      expectClosedManifold(mesh, "noise");
      expectSameTopology(mesh, finest);
      EXPECT_LT(mesh.triangleCount(), finest.triangleCount());
    }
    const auto tree = test::randomTree<openvdb::DoubleGrid>({.seed = seed, .blocks = 6});
    expectClosedManifold(merged(*tree, atZero(180), 1000), "tree");
  }
  for (const double length : {1.0, 1.5, 2.5, 5.0}) {
    const auto grid = waves(length);
    const Mesh finest = merged(*grid, atZero(180), 0);
    for (const double tolerance : {0.5, 2.0, 1000.0}) {
      const Mesh mesh = merged(*grid, atZero(180), tolerance);
      expectClosedManifold(mesh, "waves of " + std::to_string(length));
      expectSameTopology(mesh, finest);
      EXPECT_LT(mesh.triangleCount(), finest.triangleCount());
    }
  }
}

// How far vertices and the middles of triangles are from a sphere of radius 1, in voxels.
double farthestFromSphere(const Mesh& mesh, double voxelSize) {
  double most = 0;
  const auto add = [&](double x, double y, double z) {
    most = std::max(most, std::abs(std::hypot(x, y, z) - 1) / voxelSize);
  };
  for (const Triangle& triangle : mesh.triangles) {
    double x = 0, y = 0, z = 0;
    for (const VertexIndex v : triangle.vertices) {
      const Position& p = mesh.positions[v];
      add(p.x, p.y, p.z);
      x += p.x / 3, y += p.y / 3, z += p.z / 3;
    }
    add(x, y, z);
  }
  return most;
}

TEST(MergedCells, AreFewerAndWithinTheTolerance) {
  const auto ball = test::shapeOf(Shape::Sphere, 0.02);
  const std::size_t finest = merged(*ball, {}, 0).triangleCount();
  double factor = 7;
  for (const double tolerance : {0.1, 0.5}) {
    const Mesh mesh = merged(*ball, {}, tolerance);
    EXPECT_LT(factor * static_cast<double>(mesh.triangleCount()), static_cast<double>(finest));
    factor = 50;
    const double most = farthestFromSphere(mesh, 0.02);
    EXPECT_LT(most, tolerance);
    EXPECT_GT(most, 0.1 * tolerance);
  }
}

TEST(MergedCells, AreBroughtToTheSurfaceByRefining) {
  const auto ball = test::shapeOf(Shape::Sphere, 0.04);
  ExtractOptions options;
  options.refine = 0.05;
  const Mesh mesh = merged(*ball, options, 0.5);
  expectClosedManifold(mesh, "refined");
  EXPECT_LT(farthestFromSphere(mesh, 0.04), 0.1);
  EXPECT_LT(mesh.triangleCount(), merged(*ball, {}, 0).triangleCount());
}

TEST(MergedCells, LeaveCreasesAsTheyAre) {
  const auto box = test::shapeOf(Shape::Box, 0.04);
  const Mesh finest = merged(*box, {}, 0), mesh = merged(*box, {}, 0.5);
  EXPECT_LT(2 * mesh.triangleCount(), finest.triangleCount());
  EXPECT_NEAR(test::volume(mesh), test::volume(finest), 1e-5 * test::volume(finest));
  const auto reach = [](const Mesh& of) {
    double most = 0;
    for (const Position& p : of.positions) most = std::max(most, std::hypot(p.x, p.y, p.z));
    return most;
  };
  EXPECT_EQ(reach(mesh), reach(finest));  // a corner
}

TEST(MergedCells, AreTheSameForAnyThreadsAndNotTurnedOverByMirrors) {
  auto grid = test::shapeOf(Shape::Torus, 0.02);
  ExtractOptions one, two;
  one.contour.threads = 1;
  two.contour.threads = 2;
  const Mesh mesh = merged(*grid, one, 0.5);
  EXPECT_TRUE(test::sameBytes(mesh, merged(*grid, two, 0.5)));
  const auto map = openvdb::Mat4d(-0.02, 0.0, 0.0, 0.0, 0.004, 0.03, 0.0, 0.0, 0.0, 0.01, 0.02, 0.0,
                                  5.0, -7.0, 9.0, 1.0);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(map));
  expectClosedManifold(merged(*grid, {}, 0.5), "mirrored");
}

TEST(MergedCells, EndWhereTheDataEndsUnlessItIsCapped) {
  auto half = test::shapeOf(Shape::Sphere, 0.02);
  half->clip(CoordBBox(openvdb::Coord(-1000, -1000, -1000), openvdb::Coord(1000, 1000, 3)));
  const test::MeshTopology topology = test::inspect(merged(*half, {}, 0.5));
  EXPECT_TRUE(topology.manifold()) << topology;
  EXPECT_GT(topology.boundaryEdges, 0U);
  ExtractOptions options;
  options.contour.cap = true;
  expectClosedManifold(merged(*half, options, 0.5), "capped");
}

TEST(MergedCells, RefuseAToleranceThatIsNone) {
  const auto ball = test::shapeOf(Shape::Sphere, 0.2);
  for (const double tolerance : {-0.1, std::numeric_limits<double>::quiet_NaN()}) {
    test::expectError(ErrorCode::InvalidArgument, "tolerance of merging",
                      [&] { (void)merged(*ball, {}, tolerance); });
  }
}

// A regular polygon whose corners lie on the faces told of.
std::vector<extraction::LoopCorner> polygon(const std::vector<std::uint8_t>& faces, Mesh& mesh) {
  std::vector<extraction::LoopCorner> loop;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double turn =
        6.283185307179586 * static_cast<double>(i) / static_cast<double>(faces.size());
    loop.push_back({static_cast<VertexIndex>(i), faces[i]});
    mesh.positions.emplace_back(std::cos(turn), std::sin(turn), 0.5);
    mesh.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  return loop;
}

TEST(FillLoop, TakesTheShortestChordsThatLieInNoFace) {
  // Around four upright edges, between faces 0, 2, 1 and 3.
  Mesh mesh;
  extraction::BlockTriangles four;
  extraction::fillLoop(polygon({0b0101, 0b0110, 0b1010, 0b1001}, mesh), mesh, four);
  EXPECT_EQ(four.triangles.size(), 2U);
  EXPECT_TRUE(four.positions.empty());
  for (const Triangle& t : four.triangles) EXPECT_LT(t.vertices[0], t.vertices[2]);
  // The first chord that comes to mind, from 0 to 2, lies in face 0.
  mesh = {};
  extraction::BlockTriangles other;
  extraction::fillLoop(polygon({0b0001, 0b0100, 0b0001, 0b1000}, mesh), mesh, other);
  ASSERT_EQ(other.triangles.size(), 2U);
  for (const Triangle& t : other.triangles) {
    const auto has = [&](VertexIndex v) {
      return std::find(t.vertices.begin(), t.vertices.end(), v) != t.vertices.end();
    };
    EXPECT_TRUE(has(1) && has(3));
  }
}

TEST(FillLoop, MakesAFanWhereThereAreNoSuchChordsOrManyCorners) {
  for (const std::size_t corners : {5U, 40U}) {
    Mesh mesh;
    extraction::BlockTriangles fan;
    extraction::fillLoop(polygon(std::vector<std::uint8_t>(corners, corners == 5 ? 1 : 0), mesh),
                         mesh, fan);
    EXPECT_EQ(fan.triangles.size(), corners);
    ASSERT_EQ(fan.positions.size(), 1U);
    EXPECT_NEAR(fan.positions[0].x, 0, 1e-9);
    EXPECT_NEAR(fan.positions[0].z, 0.5, 1e-9);
    EXPECT_EQ(fan.normals[0].z, 1.0F);
  }
}

}  // namespace
}  // namespace tufa
