#include <gtest/gtest.h>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <tufa/check.h>
#include <random>

#include "unit/check/meshes.h"

namespace tufa {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using test::joined;
using test::tetrahedron;

/// CGAL's count, without the pairs (f, f) that it makes of degenerate faces.
std::size_t countByCgal(const Mesh& mesh) {
  SurfaceMesh surface;
  for (const Position& p : mesh.positions) surface.add_vertex(Kernel::Point_3(p.x, p.y, p.z));
  for (const Triangle& face : triangulate(mesh)) {
    const auto& v = face.vertices;
    using Index = SurfaceMesh::Vertex_index;
    EXPECT_NE(surface.add_face(Index(v[0]), Index(v[1]), Index(v[2])), SurfaceMesh::null_face());
  }
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(pairs));
  std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
  return pairs.size();
}

std::size_t countPairs(const Mesh& mesh) { return check(mesh).selfIntersectingPairs.value(); }

TEST(CheckIntersections, NotAskedForMeansUnset) {
  const CheckReport report = check(tetrahedron(Position(0, 0, 0)), {.selfIntersections = false});
  EXPECT_FALSE(report.selfIntersectingPairs.has_value());
  EXPECT_FALSE(report.boundsVolume);
  EXPECT_TRUE(report.watertight());
}

TEST(CheckIntersections, PiercingTetrahedra) {
  const Mesh mesh =
      joined(tetrahedron(Position(0, 0, 0), 4), tetrahedron(Position(0.5, 0.6, -0.7), 2));
  EXPECT_GT(countPairs(mesh), 0U);
  EXPECT_EQ(countPairs(mesh), countByCgal(mesh));
  EXPECT_FALSE(check(mesh).boundsVolume);
}

TEST(CheckIntersections, OneTriangleThroughAnother) {
  Mesh mesh;
  mesh.positions = {Position(0, 0, 0),      Position(4, 0, 0),     Position(0, 4, 0),
                    Position(0.5, 0.5, -1), Position(0.5, 0.5, 1), Position(-9, 0.5, 0)};
  mesh.triangles = {Triangle(0, 1, 2), Triangle(3, 4, 5)};
  EXPECT_EQ(countPairs(mesh), 1U);
}

TEST(CheckIntersections, FoldedNeighbours) {
  Mesh mesh;
  mesh.positions = {Position(0, 0, 0), Position(1, 0, 0), Position(0, 1, 0), Position(1, 2, 0)};
  mesh.triangles = {Triangle(0, 1, 2), Triangle(1, 0, 3)};
  EXPECT_EQ(countPairs(mesh), 1U);
  EXPECT_EQ(countByCgal(mesh), 1U);
  mesh.positions[3] = Position(1, -2, 0);  // flat, not folded
  EXPECT_EQ(countPairs(mesh), 0U);
  mesh.positions[3] = Position(1, 2, 1e-300);  // nearly folded
  EXPECT_EQ(countPairs(mesh), 0U);
}

TEST(CheckIntersections, TrianglesAtOneVertex) {
  Mesh mesh;
  mesh.positions = {Position(0, 0, 0), Position(2, 0, 0),  Position(0, 2, 0),
                    Position(1, 1, 1), Position(1, 1, -1), Position(-1, -1, 0)};
  // The far edge of the second passes the far edge of the first, then stays away from it.
  mesh.triangles = {Triangle(0, 1, 2), Triangle(0, 3, 4)};
  EXPECT_EQ(countPairs(mesh), 1U);
  EXPECT_EQ(countByCgal(mesh), 1U);
  mesh.positions[3] = Position(-1, -1, 1);
  mesh.positions[4] = Position(-1, -1, -1);
  EXPECT_EQ(countPairs(mesh), 0U);
  mesh.positions[3] = Position(0.5, 0.25, 0);  // in the plane, inside
  EXPECT_EQ(countPairs(mesh), 1U);
}

TEST(CheckIntersections, TouchingWithoutSharedIndexIsAPair) {
  const Mesh mesh = joined(tetrahedron(Position(0, 0, 0)), tetrahedron(Position(1, 0, 0)));
  EXPECT_EQ(countPairs(mesh), 9U);
  EXPECT_EQ(countByCgal(mesh), 9U);
}

TEST(CheckIntersections, AgreesWithCgalOnShakenMeshes) {
  std::mt19937 random(7);
  for (const double amount : {0.0, 0.05, 0.3, 1.0}) {
    Mesh mesh = joined(test::torus(3, 1, 40, 20), test::sphere(2.5, 4));
    std::uniform_real_distribution<double> shake(-amount, amount);
    for (Position& p : mesh.positions) {
      p = Position(p.x + shake(random), p.y + shake(random), p.z + shake(random));
    }
    EXPECT_EQ(countPairs(mesh), countByCgal(mesh)) << "amount " << amount;
  }
}

TEST(CheckIntersections, AgreesWithCgalOnLatticeMeshes) {
  // Coordinates on a coarse lattice: coplanar, touching and degenerate faces all occur.
  std::mt19937 random(11);
  for (int run = 0; run < 6; ++run) {
    Mesh mesh = test::torus(6, 3, 20, 16);
    std::uniform_int_distribution<int> shake(-1, 1);
    for (Position& p : mesh.positions) {
      p = Position(std::round(p.x) + shake(random), std::round(p.y) + shake(random),
                   std::round(p.z) + shake(random));
    }
    EXPECT_EQ(countPairs(mesh), countByCgal(mesh)) << "run " << run;
  }
}

TEST(CheckIntersections, RandomSoupIsTakenWithoutHarm) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> coordinate(0, 3);
  std::uniform_int_distribution<VertexIndex> vertex(0, 44);  // some out of range
  Mesh mesh;
  for (int i = 0; i < 40; ++i) {
    mesh.positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  }
  for (int i = 0; i < 200; ++i) {
    mesh.triangles.emplace_back(vertex(random), vertex(random), vertex(random));
    mesh.quads.emplace_back(vertex(random), vertex(random), vertex(random), vertex(random));
  }
  for (const bool weld : {false, true}) {
    const CheckReport report = check(mesh, {.weld = weld});
    EXPECT_FALSE(report.watertight());
    EXPECT_GT(report.selfIntersectingPairs.value(), 0U);
    EXPECT_GT(report.invalidFaces, 0U);
  }
}

TEST(CheckIntersections, HugeAndTinyCoordinates) {
  for (const double size : {1e-200, 1e150, 1e307}) {
    const CheckReport report = check(tetrahedron(Position(0, 0, 0), size));
    EXPECT_TRUE(report.closed && report.manifold && report.oriented);
    EXPECT_EQ(report.selfIntersectingPairs, 0U);
    EXPECT_EQ(report.degenerateFaces, 0U);
  }
}

}  // namespace
}  // namespace tufa
