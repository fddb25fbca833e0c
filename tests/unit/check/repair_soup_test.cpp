// repair(): soups of triangles become watertight, or at least no worse.

#include <tufa/repair.h>

#include <gtest/gtest.h>

#include <tufa/error.h>
#include <limits>
#include <random>

#include "support/expect_error.h"
#include "unit/check/meshes.h"

namespace tufa {
namespace {

/// Every triangle with three vertices of its own, as .stl files have them.
Mesh exploded(const Mesh& mesh, double jitter = 0) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shift(-jitter, jitter);
  Mesh soup;
  for (const Triangle& triangle : triangulate(mesh)) {
    for (const VertexIndex v : triangle.vertices) {
      const Position& p = mesh.positions[v];
      soup.positions.emplace_back(p.x + shift(random), p.y + shift(random), p.z + shift(random));
    }
    const auto first = static_cast<VertexIndex>(soup.positions.size() - 3);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  return soup;
}

Mesh cube() { return test::box(Position(0, 0, 0), Position(1, 2, 3)); }

TEST(RepairSoup, LeavesAWatertightMeshAsItIs) {
  RepairReport report;
  const Mesh mesh = repair(cube(), {}, &report);
  EXPECT_TRUE(report.before.watertight() && report.after.watertight());
  EXPECT_EQ(mesh.positions, cube().positions);
  EXPECT_EQ(report.mergedVertices + report.degenerateFaces + report.duplicateFaces, 0U);
  EXPECT_EQ(report.splitVertices + report.filledHoles, 0U);
  EXPECT_FALSE(report.keptInput);
}

TEST(RepairSoup, MergesVerticesAtOnePlaceOrNear) {
  RepairReport report;
  (void)repair(exploded(cube()), {}, &report);
  EXPECT_FALSE(report.before.closed);
  EXPECT_TRUE(report.after.watertight());
  EXPECT_EQ(report.mergedVertices, 36U - 8U);
  (void)repair(exploded(cube(), 0.001), {}, &report);
  EXPECT_FALSE(report.after.closed);
  RepairOptions options;
  options.mergeDistance = 0.01;
  (void)repair(exploded(cube(), 0.001), options, &report);
  EXPECT_TRUE(report.after.watertight());
  EXPECT_NEAR(report.after.volume, 6, 0.05);
}

// Vertices of no face counted as merged.
TEST(RepairSoup, CountsUnusedVerticesByThemselves) {
  Mesh mesh = cube();
  mesh.positions.insert(mesh.positions.begin(), 5, Position(7, 7, 7));
  for (Quad& q : mesh.quads) {
    for (VertexIndex& v : q.vertices) v += 5;
  }
  for (Triangle& t : mesh.triangles) {
    for (VertexIndex& v : t.vertices) v += 5;
  }
  RepairReport report;
  EXPECT_EQ(repair(mesh, {}, &report).positions.size(), 8U);
  EXPECT_EQ(report.mergedVertices, 0U);
  EXPECT_EQ(report.unusedVertices, 5U);
}

TEST(RepairSoup, DropsDegenerateDuplicateAndInvalidFacesAndOrientsTheOthers) {
  Mesh mesh = exploded(cube());
  mesh.triangles.push_back(mesh.triangles[3]);
  mesh.triangles.emplace_back(0, 0, 1);
  mesh.triangles.emplace_back(0, 1, 999);
  mesh.positions.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  mesh.triangles.emplace_back(0, 1, static_cast<VertexIndex>(mesh.positions.size() - 1));
  std::swap(mesh.triangles[5].vertices[0], mesh.triangles[5].vertices[1]);
  RepairReport report;
  (void)repair(mesh, {}, &report);
  EXPECT_TRUE(report.after.watertight());
  EXPECT_EQ(report.duplicateFaces, 1U);
  EXPECT_EQ(report.degenerateFaces, 3U);
  EXPECT_NEAR(report.after.volume, 6, 1e-9);
}

TEST(RepairSoup, TurnsAClosedMeshOutward) {
  RepairReport report;
  (void)repair(test::inverted(cube()), {}, &report);
  EXPECT_FALSE(report.before.outward);
  EXPECT_TRUE(report.after.watertight());
}

// All faces were turned after the first one.
TEST(RepairSoup, TurnsThePartsOfFewFacesToThoseOfMost) {
  Mesh bowl = test::sphere(1, 3);
  std::erase_if(bowl.triangles,
                [&](const Triangle& t) { return bowl.positions[t.vertices[0]].z > 0.5; });
  for (const bool inward : {false, true}) {
    Mesh mesh = test::joined(inward ? test::inverted(bowl) : bowl, cube());
    const double volume = check(mesh).volume;
    std::swap(mesh.triangles[0].vertices[1], mesh.triangles[0].vertices[2]);
    RepairReport report;
    (void)repair(mesh, {}, &report);
    EXPECT_TRUE(report.after.oriented);
    // That of an open part depends a little on the vertex that it is taken about.
    EXPECT_NEAR(report.after.volume, volume, 0.5) << inward;
  }
  // Two spheres through each other.
  Mesh other = test::sphere(1, 3);
  for (Position& p : other.positions) p.x += 1;
  Mesh two = test::joined(test::sphere(1, 3), other);
  std::swap(two.triangles[0].vertices[1], two.triangles[0].vertices[2]);
  EXPECT_TRUE(check(repair(two)).watertight());
}

TEST(RepairSoup, TurnsClosedPartsOutwardBesideSheets) {
  Mesh mesh = test::inverted(cube());
  mesh.positions.insert(mesh.positions.end(), {{5, 5, 5}, {6, 5, 5}, {5, 6, 5}});
  mesh.triangles.emplace_back(8, 9, 10);
  RepairReport report;
  (void)repair(mesh, {}, &report);
  EXPECT_EQ(report.after.triangles, 13U);
  EXPECT_NEAR(report.after.volume, 6, 1e-9);
}

// The outline of a triangle is no hole. Filled, it was a closed part of a face and its duplicate.
TEST(RepairSoup, FillsNoOutlineOfASheet) {
  Mesh mesh = cube();
  mesh.positions.insert(mesh.positions.end(), {{5, 5, 5}, {6, 5, 5}, {5, 6, 5}, {6, 6, 5}});
  mesh.triangles.emplace_back(8, 9, 10);
  for (const bool isStrip : {false, true}) {
    if (isStrip) mesh.triangles.emplace_back(9, 11, 10);
    RepairOptions options;
    options.fillEdges = 10;
    options.dropOpen = true;
    RepairReport report;
    (void)repair(mesh, options, &report);
    EXPECT_EQ(report.filledHoles, 0U);
    EXPECT_EQ(report.droppedParts, 1U);
    EXPECT_TRUE(report.after.watertight());
  }
}

TEST(RepairSoup, FillsHolesUpToTheNumberOfEdges) {
  Mesh mesh = cube();
  mesh.quads.pop_back();
  RepairReport report;
  RepairOptions options;
  options.fillEdges = 3;
  (void)repair(mesh, options, &report);
  EXPECT_FALSE(report.after.closed);
  EXPECT_EQ(report.filledHoles, 0U);
  options.fillEdges = 4;
  (void)repair(mesh, options, &report);
  EXPECT_TRUE(report.after.watertight());
  EXPECT_EQ(report.filledHoles, 1U);
  EXPECT_NEAR(report.after.volume, 6, 1e-9);
}

TEST(RepairSoup, SplitsEdgesAndVerticesThatAreNotManifold) {
  // Two cubes that share an edge, and a tetrahedron that touches a corner.
  Mesh mesh = test::joined(test::joined(test::box(Position(0, 0, 0), Position(1, 1, 1)),
                                        test::box(Position(1, 1, 0), Position(2, 2, 1))),
                           test::tetrahedron(Position(2, 2, 1)));
  RepairReport report;
  const Mesh merged = exploded(mesh);
  (void)repair(merged, {}, &report);
  EXPECT_TRUE(report.after.manifold);
  EXPECT_TRUE(report.after.closed);
  EXPECT_GE(report.splitVertices, 3U);
}

TEST(RepairSoup, DropsDanglingSheetsIfAsked) {
  Mesh mesh = cube();
  mesh.positions.emplace_back(5, 5, 5);
  mesh.positions.emplace_back(6, 5, 5);
  mesh.positions.emplace_back(5, 6, 5);
  mesh.triangles.emplace_back(8, 9, 10);
  RepairReport report;
  (void)repair(mesh, {}, &report);
  EXPECT_FALSE(report.after.closed);
  RepairOptions options;
  options.dropOpen = true;
  (void)repair(mesh, options, &report);
  EXPECT_TRUE(report.after.watertight());
  EXPECT_EQ(report.droppedParts, 1U);
}

TEST(RepairSoup, NeverGivesAWorseMesh) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Mesh mesh;
    for (int i = 0; i < 12; ++i) {
      mesh.positions.emplace_back(random() % 4, random() % 4, random() % 4);
    }
    for (int i = 0; i < 20; ++i) {
      mesh.triangles.emplace_back(random() % 13, random() % 12, random() % 12);
    }
    RepairReport report;
    RepairOptions options;
    options.fillEdges = round % 2 == 0 ? 0 : 8;
    const Mesh repaired = repair(mesh, options, &report);
    const auto faults = [](const CheckReport& r) {
      return r.boundaryEdges + r.nonManifoldEdges + r.nonManifoldVertices + r.misorientedEdges +
             r.invalidFaces + r.collapsedFaces + r.duplicateFaces;
    };
    EXPECT_LE(faults(check(repaired)), faults(check(mesh))) << round;
  }
}

TEST(RepairSoup, OfNoFacesIsEmptyAndMergingAllKeepsTheInput) {
  Mesh points;
  points.positions = {Position(0, 0, 0), Position(1, 0, 0)};
  EXPECT_TRUE(repair(points).positions.empty());
  EXPECT_TRUE(repair({}).positions.empty());
  RepairReport report;
  RepairOptions options;
  options.mergeDistance = 100;
  EXPECT_EQ(repair(cube(), options, &report).triangleCount(), cube().triangleCount());
  EXPECT_TRUE(report.keptInput);
}

// Two cubes side by side, each closed, are watertight; their merged vertices are not.
TEST(RepairSoup, NeverOpensWhatIsWatertight) {
  Mesh two = cube();
  const auto vertices = static_cast<VertexIndex>(two.positions.size());
  const Mesh other = test::box(Position(1, 0, 0), Position(2, 2, 3));
  two.positions.insert(two.positions.end(), other.positions.begin(), other.positions.end());
  for (Quad q : other.quads) {
    for (VertexIndex& v : q.vertices) v += vertices;
    two.quads.push_back(q);
  }
  ASSERT_TRUE(check(two).watertight());
  for (const int fill : {0, 10}) {
    RepairOptions options;
    options.fillEdges = fill;
    EXPECT_TRUE(check(repair(two, options)).watertight()) << fill;
  }
}

TEST(RepairSoup, RefusesOptionsOutOfRangeAndStops) {
  RepairOptions options;
  options.mergeDistance = -1;
  test::expectError(ErrorCode::InvalidArgument, "merge", [&] { (void)repair(cube(), options); });
  options = {};
  options.fillEdges = -1;
  test::expectError(ErrorCode::InvalidArgument, "holes", [&] { (void)repair(cube(), options); });
  options = {};
  for (int stop = 1; stop < 12; ++stop) {
    int calls = 0;
    options.progress = [&](std::string_view, double) { return ++calls < stop; };
    test::expectError(ErrorCode::Cancelled, "cancelled", [&] { (void)repair(cube(), options); });
  }
}

}  // namespace
}  // namespace tufa
