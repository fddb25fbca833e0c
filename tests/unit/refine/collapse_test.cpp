#include "refine/collapse/collapse.h"

#include <gtest/gtest.h>
#include <tufa/contour.h>
#include <tufa/shapes.h>

#include <algorithm>
#include <vector>

#include "base/quadric.h"
#include "refine/collapse/edge_queue.h"
#include "refine/collapse/least_point.h"
#include "support/mesh_oracle.h"
#include "support/uniform_mesh.h"

namespace tufa::refine {
namespace {

struct Problem {
  Mesh mesh;
  std::vector<base::Quadric> planes;
  Bounds bounds;
};

// A uniform mesh, each vertex with its own plane, and all vertices as samples.
Problem problemOf(Shape shape, double voxelSize, double budget) {
  ShapeOptions options;
  options.voxelSize = voxelSize;
  Problem problem;
  problem.mesh = test::uniformMesh(*makeShape(shape, options));
  const Mesh& mesh = problem.mesh;
  std::vector<std::uint32_t> polygonOf(mesh.positions.size());
  for (std::uint32_t i = 0; i < mesh.quads.size(); ++i) {
    for (const VertexIndex vertex : mesh.quads[i].vertices) polygonOf[vertex] = i;
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Normal& n = mesh.normals[i];
    problem.planes.emplace_back().addPlane(Vec3(0.0), Vec3(n));
    problem.bounds.samples.push_back({mesh.positions[i], n, polygonOf[i]});
  }
  problem.bounds.budget.assign(mesh.positions.size(), static_cast<float>(budget * voxelSize));
  problem.bounds.distance = [](const Vec3&, const Vec3&, double) { return 0.0; };
  return problem;
}

Collapsed solve(const Problem& problem, int threads = 1) {
  base::Job job(threads, {});
  return collapse(problem.mesh, problem.planes, problem.bounds, job);
}

TEST(LeastPoint, IsWhereThePlanesMeet) {
  base::Quadric sum;
  const Vec3 corner(0.3, -0.2, 0.1);
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(0, 0.6, 0.8), Vec3(0, -0.8, 0.6)}) {
    sum.addPlane(corner, normal);
  }
  EXPECT_NEAR((leastPoint(sum) - corner).length(), 0, 2e-3);
}

TEST(LeastPoint, LeavesFreeDirectionsAlone) {
  base::Quadric sum;
  sum.addPlane(Vec3(0, 0, 2), Vec3(0, 0, 1));
  const Vec3 least = leastPoint(sum);
  EXPECT_EQ(least[0], 0);
  EXPECT_EQ(least[1], 0);
  EXPECT_NEAR(least[2], 2, 1e-2);
}

TEST(EdgeQueue, GivesTheLeastFirstAndEqualOnesInTurn) {
  EdgeQueue queue;
  queue.push(4, {4, 0, 0, 0});
  queue.push(1, {1, 0, 0, 0});
  queue.push(1, {2, 0, 0, 0});
  EdgeQueue::Entry entry{};
  ASSERT_TRUE(queue.pop(entry));
  EXPECT_EQ(entry.a, 1U);
  queue.push(0, {0, 0, 0, 0});
  for (const VertexIndex expected : {0U, 2U, 4U}) {
    ASSERT_TRUE(queue.pop(entry));
    EXPECT_EQ(entry.a, expected);
  }
  EXPECT_FALSE(queue.pop(entry));
}

TEST(Collapse, KeepsTheTopology) {
  for (const Shape shape : {Shape::Sphere, Shape::Torus, Shape::Gyroid}) {
    const Problem problem = problemOf(shape, 0.06, 0.2);
    const Collapsed collapsed = solve(problem);
    const test::MeshTopology before = test::inspect(problem.mesh),
                             after = test::inspect(test::triangulated(collapsed.mesh));
    EXPECT_TRUE(after.manifold() && after.closed()) << after;
    EXPECT_EQ(after.euler(), before.euler());
    EXPECT_EQ(after.components, before.components);
    EXPECT_LT(collapsed.mesh.triangleCount(), problem.mesh.triangleCount() * 4 / 5);
    ASSERT_EQ(collapsed.vertexOf.size(), problem.mesh.positions.size());
    ASSERT_EQ(collapsed.sources.size(),
              collapsed.mesh.quads.size() + collapsed.mesh.triangles.size());
  }
}

TEST(Collapse, LeavesWhatMayNotMove) {
  Problem problem = problemOf(Shape::Sphere, 0.1, 0.5);
  std::fill(problem.bounds.budget.begin(), problem.bounds.budget.end(), 0.0F);
  const Collapsed collapsed = solve(problem);
  EXPECT_EQ(collapsed.mesh.positions, problem.mesh.positions);
  EXPECT_EQ(collapsed.mesh.quads, problem.mesh.quads);
}

TEST(Collapse, StopsAtSoManyTriangles) {
  Problem problem = problemOf(Shape::Sphere, 0.06, 1);
  const std::size_t half = problem.mesh.triangleCount() / 2;
  problem.bounds.triangles = half;
  EXPECT_LE(solve(problem).mesh.triangleCount(), half);
  EXPECT_GE(solve(problem).mesh.triangleCount(), half - 1);
}

TEST(Collapse, LoosensItsBoundsForANumberOfTriangles) {
  Problem problem = problemOf(Shape::Torus, 0.06, 0.05);
  const Collapsed bounded = solve(problem);
  EXPECT_EQ(bounded.budgetScale, 1);
  problem.bounds.triangles = bounded.mesh.triangleCount() / 4;
  const Collapsed widerBudget = solve(problem);
  EXPECT_LE(widerBudget.mesh.triangleCount(), problem.bounds.triangles);
  EXPECT_GE(widerBudget.mesh.triangleCount(), problem.bounds.triangles - 1);
  EXPECT_GT(widerBudget.budgetScale, 1);
  // As few as that has no torus.
  problem.bounds.triangles = 4;
  const Collapsed least = solve(problem);
  EXPECT_GT(least.mesh.triangleCount(), 4U);
  const test::MeshTopology topology = test::inspect(test::triangulated(least.mesh));
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  EXPECT_EQ(topology.euler(), 0);
}

TEST(Collapse, RepeatsAResult) {
  Problem problem = problemOf(Shape::Torus, 0.06, 0.3);
  const Collapsed first = solve(problem);
  problem.bounds.before = &first;
  const Collapsed second = solve(problem);
  EXPECT_EQ(second.mesh.positions, first.mesh.positions);
  EXPECT_EQ(second.mesh.triangles, first.mesh.triangles);
  EXPECT_EQ(second.vertexOf, first.vertexOf);
}

TEST(Collapse, RepeatsAResultOnlyWhereThatIsStillAllowed) {
  Problem problem = problemOf(Shape::Torus, 0.06, 0.3);
  const Collapsed first = solve(problem);
  problem.bounds.before = &first;
  for (std::size_t i = 0; i < problem.mesh.positions.size(); ++i) {
    if (problem.mesh.positions[i].x > 0) problem.bounds.budget[i] = 0;
  }
  const Collapsed second = solve(problem);
  const test::MeshTopology topology = test::inspect(test::triangulated(second.mesh));
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  EXPECT_EQ(topology.euler(), 0);
  EXPECT_GT(second.mesh.triangleCount(), first.mesh.triangleCount());
  for (std::size_t i = 0; i < problem.mesh.positions.size(); ++i) {
    if (problem.bounds.budget[i] > 0) continue;
    EXPECT_EQ(second.members[second.vertexOf[i]], 1U);
  }
}

TEST(Collapse, UndoesStepsAndThoseThatNeedThem) {
  Problem problem = problemOf(Shape::Sphere, 0.06, 0.3);
  const Collapsed first = solve(problem);
  problem.bounds.before = &first;
  problem.bounds.onlyRepeat = true;
  problem.bounds.rolledBack.assign(first.steps.size(), 0);
  problem.bounds.rolledBack[first.steps.size() / 2] = 1;
  const Collapsed some = solve(problem);
  EXPECT_GT(some.mesh.triangleCount(), first.mesh.triangleCount());
  EXPECT_LT(some.mesh.triangleCount(), problem.mesh.triangleCount());
  problem.bounds.rolledBack.assign(first.steps.size(), 1);
  EXPECT_EQ(solve(problem).mesh.positions, problem.mesh.positions);
}

void expectSame(const Collapsed& one, const Collapsed& other) {
  EXPECT_EQ(one.mesh.positions, other.mesh.positions);
  EXPECT_EQ(one.mesh.triangles, other.mesh.triangles);
  EXPECT_EQ(one.mesh.quads, other.mesh.quads);
  EXPECT_EQ(one.vertexOf, other.vertexOf);
  EXPECT_EQ(one.sampleTriangles, other.sampleTriangles);
  EXPECT_EQ(one.phases, other.phases);
}

TEST(Collapse, TakesLargeMeshesInRegions) {
  const Problem problem = problemOf(Shape::Torus, 0.02, 0.3);
  const Collapsed one = solve(problem);
  ASSERT_GT(one.phases.size(), 2U);
  EXPECT_GT(one.phases.front().size(), 2U);
  EXPECT_EQ(one.phases.back().back(), one.steps.size());
  const test::MeshTopology topology = test::inspect(test::triangulated(one.mesh));
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  EXPECT_EQ(topology.euler(), 0);
  EXPECT_LT(one.mesh.triangleCount(), problem.mesh.triangleCount() / 4);
  for (const int threads : {2, 3}) expectSame(solve(problem, threads), one);
}

TEST(Collapse, RepeatsAResultOfRegions) {
  Problem problem = problemOf(Shape::Torus, 0.02, 0.3);
  const Collapsed first = solve(problem);
  problem.bounds.before = &first;
  const Collapsed second = solve(problem, 2);
  EXPECT_EQ(second.mesh.positions, first.mesh.positions);
  EXPECT_EQ(second.mesh.triangles, first.mesh.triangles);
  // Where some are undone, others take their place.
  problem.bounds.rolledBack.assign(first.steps.size(), 0);
  for (std::size_t i = 0; i < first.steps.size(); i += 100) problem.bounds.rolledBack[i] = 1;
  const Collapsed one = solve(problem, 1);
  EXPECT_NE(one.mesh.positions, first.mesh.positions);
  expectSame(solve(problem, 2), one);
  const test::MeshTopology topology = test::inspect(test::triangulated(one.mesh));
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  EXPECT_EQ(topology.euler(), 0);
}

// A pyramid that stands on its top; c lies almost on the edge from a to b.
Problem pyramid() {
  Problem problem;
  Mesh& mesh = problem.mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {1, 0.01, 0}, {1, -1, 0}, {1, 0, -1}};
  constexpr VertexIndex kA = 0, kB = 1, kC = 2, kD = 3, kTop = 4;
  mesh.triangles = {{kA, kB, kC}, {kB, kA, kD}};
  const VertexIndex around[] = {kA, kD, kB, kC, kA};
  for (int i = 0; i < 4; ++i) mesh.triangles.emplace_back(around[i + 1], around[i], kTop);
  mesh.normals.assign(5, Normal(0, 0, 1));
  problem.planes.resize(5);
  problem.bounds.budget.assign(5, 0);
  problem.bounds.turning.assign(5, 0.1F);
  problem.bounds.distance = [](const Vec3&, const Vec3&, double) { return 0.0; };
  return problem;
}

// Four triangles that are a closed surface may come from two quads with the same corners.
TEST(Collapse, GivesATetrahedronAsTriangles) {
  Problem problem;
  problem.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  problem.mesh.normals.resize(4);
  problem.mesh.quads = {{0, 2, 1, 3}, {3, 1, 2, 0}};
  problem.planes.resize(4);
  problem.bounds.budget.assign(4, 0);
  const Mesh mesh = solve(problem).mesh;
  EXPECT_TRUE(test::inspect(mesh).manifold());
  EXPECT_EQ(mesh.triangles.size(), 4U);
}

TEST(Collapse, TurnsAnEdgeThatMakesANeedle) {
  const Problem problem = pyramid();
  const Collapsed turned = solve(problem);
  EXPECT_EQ(turned.mesh.positions, problem.mesh.positions);
  const test::MeshTopology topology = test::inspect(turned.mesh);
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  std::vector<Triangle> expected = problem.mesh.triangles;
  expected[0] = {0, 3, 2};
  expected[1] = {2, 3, 1};
  ASSERT_EQ(turned.mesh.triangles.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    auto found = turned.mesh.triangles[i].vertices, wanted = expected[i].vertices;
    std::sort(found.begin(), found.end());
    std::sort(wanted.begin(), wanted.end());
    EXPECT_EQ(found, wanted);
  }
  EXPECT_EQ(turned.turned.size(), 6U);
}

TEST(Collapse, TurnsNoEdgeWhereTheSurfaceIsTooFar) {
  Problem problem = pyramid();
  problem.bounds.distance = [](const Vec3&, const Vec3&, double) { return 0.2; };
  EXPECT_EQ(solve(problem).mesh.triangles, problem.mesh.triangles);
  problem = pyramid();
  problem.bounds.turning[3] = 0;
  EXPECT_EQ(solve(problem).mesh.triangles, problem.mesh.triangles);
}

}  // namespace
}  // namespace tufa::refine
