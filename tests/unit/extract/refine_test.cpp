// Triangles split until they are on the trilinear surface.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/extract.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "base/vec3.h"
#include "support/expect_error.h"
#include "support/fields.h"
#include "support/mesh_oracle.h"
#include "support/shape.h"

namespace tufa {
namespace {

constexpr double kVoxel = 0.125;

Mesh refined(const openvdb::GridBase& grid, Method method, double tolerance, int threads = 0,
             Refinement* reached = nullptr) {
  ExtractOptions options;
  options.refine = tolerance;
  options.contour.threads = threads;
  ContourReport report;
  Mesh mesh = extract(grid, method, options, &report);
  EXPECT_EQ(report.refinement.has_value(), tolerance > 0);
  if (reached != nullptr) *reached = report.refinement.value();
  return mesh;
}

constexpr std::array kMethods = {
    Method::Dual,        Method::MarchingCubes,        Method::MarchingCubes33,
    Method::SurfaceNets, Method::MarchingTetrahedra5,  Method::MarchingTetrahedra6,
    Method::BodyCentred, Method::MarchingTetrahedra24, Method::ExtendedMarchingCubes,
    Method::OctreeCubes};

// Of the corners and the middles of all edges and triangles of a sphere, in voxels.
double largestDistance(const Mesh& mesh) {
  double most = 0;
  const auto measure = [&](double x, double y, double z) {
    most = std::max(most, std::abs(std::hypot(x, y, z) - 1) / kVoxel);
  };
  for (const Triangle& triangle : mesh.triangles) {
    const auto at = [&](int i) { return mesh.positions[triangle.vertices[i % 3]]; };
    const Position a = at(0), b = at(1), c = at(2);
    measure((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3);
    for (int i = 0; i < 3; ++i) {
      const Position p = at(i), q = at(i + 1);
      measure(p.x, p.y, p.z);
      measure((p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2);
    }
  }
  return most;
}

double smallestAngle(const Mesh& mesh) {
  double cosine = 0;
  for (const Triangle& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const auto at = [&](int k) { return mesh.positions[triangle.vertices[(i + k) % 3]]; };
      const Position a = at(0), b = at(1), c = at(2);
      const double ab = std::hypot(b.x - a.x, b.y - a.y, b.z - a.z);
      const double ac = std::hypot(c.x - a.x, c.y - a.y, c.z - a.z);
      cosine = std::max(cosine, ((b.x - a.x) * (c.x - a.x) + (b.y - a.y) * (c.y - a.y) +
                                 (b.z - a.z) * (c.z - a.z)) /
                                    (ab * ac));
    }
  }
  return std::acos(std::min(cosine, 1.0)) * 180 / std::numbers::pi;
}

void expectSound(const Mesh& mesh, std::int64_t euler) {
  const test::MeshTopology topology = test::inspect(mesh);
  EXPECT_TRUE(topology.manifold()) << topology;
  EXPECT_EQ(topology.boundaryEdges, 0U) << topology;
  EXPECT_EQ(topology.misorientedEdges, 0U) << topology;
  EXPECT_EQ(topology.euler(), euler) << topology;
}

TEST(Refine, BringsTrianglesNearerAndLeavesNoCracks) {
  const auto ball = test::shapeOf(Shape::Sphere, kVoxel);
  // What the trilinear surface itself is off a sphere of radius 8 voxels.
  constexpr double kOwn = 0.035;
  for (const Method method : kMethods) {
    SCOPED_TRACE(methodNames().at(static_cast<std::size_t>(method)));
    std::size_t before = 0;
    for (const double tolerance : {0.02, 0.005}) {
      Refinement reached;
      const Mesh mesh = refined(*ball, method, tolerance, 0, &reached);
      expectSound(mesh, 2);
      EXPECT_TRUE(mesh.quads.empty());
      EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
      EXPECT_GE(mesh.triangleCount(), before);
      before = mesh.triangleCount();
      EXPECT_EQ(reached.rounds > 0, reached.addedVertices > 0);
      // A sliver of an adaptive mesh may have no edge left that is long enough to be split.
      const std::size_t mostLeft = method == Method::Dual ? mesh.triangleCount() / 1000 : 0;
      EXPECT_LE(reached.trianglesLeft, mostLeft);
      EXPECT_EQ(reached.creaseTriangles, 0U);
      EXPECT_LE(reached.largestVoxels, (reached.trianglesLeft > 0 ? 1.05 : 1) * tolerance);
      EXPECT_LT(largestDistance(mesh), tolerance + kOwn);
    }
  }
}

TEST(Refine, AddsWhatItReports) {
  const auto ball = test::shapeOf(Shape::Sphere, kVoxel);
  Refinement reached;
  const Mesh plain = extract(*ball, Method::MarchingCubes);
  const Mesh mesh = refined(*ball, Method::MarchingCubes, 0.01, 0, &reached);
  EXPECT_GT(reached.addedVertices, 0U);
  EXPECT_EQ(mesh.positions.size(), plain.positions.size() + reached.addedVertices);
  // Closed: each vertex in an edge makes two more triangles.
  EXPECT_EQ(mesh.triangleCount(), plain.triangleCount() + 2 * reached.addedVertices);
}

double shortestEdge(const Mesh& mesh) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Position& a = mesh.positions[triangle.vertices[i]];
      const Position& b = mesh.positions[triangle.vertices[(i + 1) % 3]];
      shortest = std::min(shortest, std::hypot(b.x - a.x, b.y - a.y, b.z - a.z) / kVoxel);
    }
  }
  return shortest;
}

// The trilinear surface has kinks, which no triangles are near enough to.
TEST(Refine, StopsAtTheFinestSizeAndSaysSo) {
  Refinement reached;
  const Mesh mesh =
      refined(*test::shapeOf(Shape::Sphere, kVoxel), Method::SurfaceNets, 1e-5, 0, &reached);
  expectSound(mesh, 2);
  EXPECT_GT(reached.trianglesLeft, 0U);
  EXPECT_GT(reached.largestVoxels, 1e-5);
  EXPECT_LT(reached.largestVoxels, 0.01);
  // Edges from the middle of one to the corner across may be shorter than its halves.
  EXPECT_GT(shortestEdge(mesh), 1.0 / 32);
}

// Repeated halving beside an edge would make angles ever smaller.
TEST(Refine, KeepsAngles) {
  const auto ball = test::shapeOf(Shape::Sphere, kVoxel);
  constexpr double kFar = 10;  // splits nothing but quads
  const double before = smallestAngle(refined(*ball, Method::SurfaceNets, kFar));
  EXPECT_GT(before, 20);
  EXPECT_GT(smallestAngle(refined(*ball, Method::SurfaceNets, 0.0005)), before / 2);
}

// The trilinear surface rounds creases off: to follow it would undo what a method restored.
TEST(Refine, LeavesCreasesAlone) {
  const auto box = test::shapeOf(Shape::Box, kVoxel);
  Refinement reached;
  const Mesh plain = refined(*box, Method::ExtendedMarchingCubes, 0);
  const Mesh mesh = refined(*box, Method::ExtendedMarchingCubes, 0.02, 0, &reached);
  EXPECT_GT(reached.creaseTriangles, 0U);
  expectSound(mesh, 2);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < plain.positions.size(); ++i) {
    kept += plain.positions[i] == mesh.positions[i] ? 1 : 0;
  }
  EXPECT_GT(kept, plain.positions.size() * 9 / 10);
}

TEST(Refine, KeepsTheTopologyOfAnyField) {
  for (const auto& field :
       {openvdb::FloatGrid::Ptr(test::noise<openvdb::FloatGrid>({.size = 10})),
        test::shapeOf(Shape::Bracket, kVoxel), test::shapeOf(Shape::Gyroid, kVoxel)}) {
    ExtractOptions options;
    options.contour.isovalue = 0;
    options.contour.inside = Inside::Below;
    for (const Method method : kMethods) {
      SCOPED_TRACE(methodNames().at(static_cast<std::size_t>(method)));
      options.refine = 0;
      const auto before = test::inspect(extract(*field, method, options));
      options.refine = 0.05;
      ContourReport report;
      expectSound(extract(*field, method, options, &report), before.euler());
      // It came to an end of its own.
      EXPECT_LT(report.refinement.value().rounds, 32);
    }
  }
}

/// The volume of each component, by the least of its vertices.
std::map<VertexIndex, double> volumes(const Mesh& mesh) {
  std::vector<VertexIndex> root(mesh.positions.size());
  std::iota(root.begin(), root.end(), VertexIndex{0});
  const auto find = [&](VertexIndex vertex) {
    while (root[vertex] != vertex) vertex = root[vertex] = root[root[vertex]];
    return vertex;
  };
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t i = 1; i < 3; ++i) {
      const VertexIndex a = find(triangle.vertices[0]), b = find(triangle.vertices[i]);
      root[std::max(a, b)] = std::min(a, b);
    }
  }
  std::map<VertexIndex, double> sums;
  for (const Triangle& triangle : mesh.triangles) {
    // From a point of the component, lest digits cancel.
    const VertexIndex least = find(triangle.vertices[0]);
    const Vec3 from(mesh.positions[least]);
    const auto at = [&](int i) { return Vec3(mesh.positions[triangle.vertices[i]]) - from; };
    sums[least] += at(0).dot(at(1).cross(at(2))) / 6;
  }
  return sums;
}

/// How many edges the mesh is folded over at: the normals of their two triangles are opposed.
std::size_t folds(const Mesh& mesh) {
  std::map<std::pair<VertexIndex, VertexIndex>, Vec3> normals;
  std::size_t count = 0;
  for (const Triangle& triangle : mesh.triangles) {
    const auto at = [&](std::size_t i) { return Vec3(mesh.positions[triangle.vertices[i]]); };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex a = triangle.vertices[i], b = triangle.vertices[(i + 1) % 3];
      normals.emplace(std::pair(a, b), normal);
      const auto beyond = normals.find({b, a});
      if (beyond == normals.end()) continue;
      const double lengths = normal.length() * beyond->second.length();
      count += normal.dot(beyond->second) < -0.9 * lengths ? 1 : 0;
    }
  }
  return count;
}

TEST(Refine, FoldsNothingAndTurnsNoPieceInsideOut) {
  const auto noise = test::noise<openvdb::FloatGrid>({.size = 24});
  ExtractOptions options;
  options.contour.isovalue = 0;
  options.contour.inside = Inside::Below;
  for (const Method method : {Method::Dual, Method::SurfaceNets, Method::MarchingCubes}) {
    SCOPED_TRACE(methodNames().at(static_cast<std::size_t>(method)));
    options.refine = 0;
    Mesh plain = extract(*noise, method, options);
    plain.triangles = triangulate(plain);
    options.refine = 0.05;
    const Mesh mesh = extract(*noise, method, options);
    const auto before = volumes(plain), after = volumes(mesh);
    ASSERT_EQ(before.size(), after.size());
    EXPECT_GT(before.size(), 20U);
    for (const auto& [least, volume] : before) EXPECT_GE(volume * after.at(least), 0) << least;
    // An edge that was folded before may be split. Without a guard there are ten times as many.
    EXPECT_LE(folds(mesh), folds(plain) * 5 / 4);
  }
}

TEST(Refine, IsTheSameForAnyNumberOfThreads) {
  const auto bracket = test::shapeOf(Shape::Bracket, kVoxel);
  for (const Method method : {Method::MarchingCubes, Method::SurfaceNets, Method::Dual}) {
    const Mesh one = refined(*bracket, method, 0.05, 1);
    EXPECT_TRUE(test::sameBytes(one, refined(*bracket, method, 0.05, 2)));
  }
}

TEST(Refine, CanBeCancelled) {
  const auto bracket = test::shapeOf(Shape::Bracket, kVoxel);
  for (const Method method : {Method::MarchingCubes, Method::Dual}) {
    ExtractOptions options;
    options.refine = 0.02;
    bool reachedRefine = false;
    double last = 0;
    options.contour.progress = [&](std::string_view stage, double fraction) {
      EXPECT_GE(fraction, last);
      last = fraction;
      reachedRefine = reachedRefine || stage == "refine";
      return stage != "refine";
    };
    test::expectError(ErrorCode::Cancelled, "", [&] { (void)extract(*bracket, method, options); });
    EXPECT_TRUE(reachedRefine);
  }
}

TEST(Refine, RefusesWhatMeansNothing) {
  const auto ball = test::shapeOf(Shape::Sphere, kVoxel);
  for (const double tolerance : {-1.0, std::numeric_limits<double>::infinity()}) {
    test::expectError(ErrorCode::InvalidArgument, "refine",
                      [&] { (void)refined(*ball, Method::MarchingCubes, tolerance); });
  }
}

}  // namespace
}  // namespace tufa
