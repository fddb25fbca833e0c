#include "refine/repair/repair.h"

#include <gtest/gtest.h>
#include <tufa/check.h>
#include <tufa/contour.h>
#include <tufa/shapes.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "base/job.h"
#include "base/single_precision.h"
#include "grid/volume.h"
#include "intersect/candidates.h"
#include "refine/lone_samples.h"
#include "support/fields.h"
#include "uniform/uniform_surface.h"

namespace tufa {
namespace {

std::vector<intersect::PolygonIndex> allPolygons(const Mesh& mesh) {
  std::vector<intersect::PolygonIndex> all(mesh.quads.size() + mesh.triangles.size());
  std::iota(all.begin(), all.end(), intersect::PolygonIndex{0});
  return all;
}

std::vector<intersect::PolygonPair> allPairs(Mesh mesh) {
  base::Job job(0, {});
  const intersect::Surface surface(mesh, job);
  return intersect::findPairs(surface, allPolygons(mesh), job);
}

openvdb::FloatGrid::Ptr makeGrid(Shape shape, double voxelSize, std::uint32_t seed = 1) {
  ShapeOptions options;
  options.voxelSize = voxelSize;
  options.seed = seed;
  return makeShape(shape, options);
}

Mesh contourOf(Shape shape, double voxelSize, bool repair, ContourReport* report = nullptr) {
  ContourOptions options;
  options.uniform = true;
  options.repair = repair;
  return contour(*makeGrid(shape, voxelSize), options, report);
}

// A sheet of 4 by 4 squares that sags, with one vertex pulled down through it.
Mesh foldedSheet() {
  Mesh mesh;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) mesh.positions.emplace_back(x, y, 0.3 * (x - 2) * (x - 2));
  }
  for (VertexIndex y = 0; y < 4; ++y) {
    for (VertexIndex x = 0; x < 4; ++x) {
      const VertexIndex v = y * 5 + x;
      mesh.quads.emplace_back(v, v + 1, v + 6, v + 5);
    }
  }
  mesh.positions[12] = {4.4, 2.1, 0.1};
  return mesh;
}

refine::Source sourceOf(const Mesh& good) {
  refine::Source source;
  source.massPoints = [&good](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> points;
    for (const VertexIndex vertex : vertices) points.push_back(good.positions[vertex]);
    return points;
  };
  return source;
}

TEST(Repair, FindsThePairsThatCheckFinds) {
  const Mesh mesh = contourOf(Shape::Bracket, 0.03, false);
  const std::vector<intersect::PolygonPair> pairs = allPairs(mesh);
  ASSERT_FALSE(pairs.empty());
  // As triangles, so that the numbers can be compared.
  Mesh split;
  split.positions = mesh.positions;
  split.triangles = triangulate(mesh);
  EXPECT_EQ(allPairs(split).size(), check(mesh).selfIntersectingPairs.value());
}

TEST(Repair, UnfoldsASheet) {
  Mesh good = foldedSheet();
  good.positions[12] = {2, 2, 0};
  ASSERT_TRUE(allPairs(good).empty());
  const Mesh before = foldedSheet();
  Mesh mesh = before;
  const std::size_t pairs = allPairs(mesh).size();
  ASSERT_GT(pairs, 0U);
  base::Job job(0, {});
  const refine::RepairReport report =
      refine::repairIntersections(mesh, allPolygons(mesh), sourceOf(good), job);
  EXPECT_EQ(report.pairsFound, pairs);
  EXPECT_TRUE(report.left.empty());
  EXPECT_TRUE(allPairs(mesh).empty());
  EXPECT_EQ(mesh.quads.size(), 16U);
  EXPECT_EQ(mesh.positions.size(), 25U);
  // It tells which vertices have moved, and from where.
  Mesh undone = mesh;
  VertexIndex next = 0;
  for (const auto& [vertex, from] : report.moved) {
    EXPECT_GE(vertex, next);
    EXPECT_NE(undone.positions[vertex], from);
    undone.positions[vertex] = from;
    next = vertex + 1;
  }
  EXPECT_EQ(report.moved.size(), 1U);
  EXPECT_EQ(undone.positions, before.positions);
}

TEST(Repair, LeavesAGoodMeshAlone) {
  Mesh mesh = contourOf(Shape::Sphere, 0.05, false);
  const Mesh before = mesh;
  base::Job job(0, {});
  const refine::RepairReport report =
      refine::repairIntersections(mesh, allPolygons(mesh), sourceOf(before), job);
  EXPECT_EQ(report.pairsFound, 0U);
  EXPECT_EQ(mesh.positions, before.positions);
  EXPECT_EQ(mesh.quads, before.quads);
}

TEST(Repair, ReportsWhatItCannotMendWithoutTheFloor) {
  // Two sheets that cross; their mass points are where they are.
  Mesh mesh;
  mesh.positions = {{0, 0, 0},  {4, 0, 0},  {4, 4, 0}, {0, 4, 0},
                    {2, 1, -2}, {2, 3, -2}, {2, 3, 2}, {2, 1, 2}};
  mesh.quads = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const Mesh before = mesh;
  refine::Source source = sourceOf(before);
  source.lastResort = false;
  base::Job job(0, {});
  const refine::RepairReport report =
      refine::repairIntersections(mesh, allPolygons(mesh), source, job);
  ASSERT_EQ(report.left.size(), 1U);
  EXPECT_EQ(report.left[0], (intersect::PolygonPair{0, 1}));
}

TEST(Repair, FansAQuadWhereNothingElseHelps) {
  // A sheet with a thin one standing in it, which the quad's crossing lies above.
  Mesh mesh;
  mesh.positions = {{0, 0, 0},    {4, 0, 0},    {4, 4, 0},   {0, 4, 0},
                    {1.9, 2, -1}, {2.1, 2, -1}, {2.1, 2, 1}, {1.9, 2, 1}};
  mesh.normals.assign(4, Normal(0, 0, 1));
  mesh.normals.insert(mesh.normals.end(), 4, Normal(0, 1, 0));
  mesh.quads = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const Mesh before = mesh;
  refine::Source source = sourceOf(before);
  source.crossings = [](const std::vector<intersect::PolygonIndex>& quads) {
    std::vector<Position> points;
    for (const intersect::PolygonIndex quad : quads) points.emplace_back(2, 2, quad == 0 ? 2 : 0);
    return points;
  };
  base::Job job(0, {});
  const refine::RepairReport report =
      refine::repairIntersections(mesh, allPolygons(mesh), source, job);
  EXPECT_EQ(report.fannedQuads, 1U);
  EXPECT_TRUE(report.left.empty());
  EXPECT_TRUE(allPairs(mesh).empty());
  ASSERT_EQ(mesh.quads.size(), 1U);
  EXPECT_EQ(mesh.quads[0], before.quads[1]);
  EXPECT_EQ(mesh.triangles.size(), 4U);
  ASSERT_EQ(mesh.positions.size(), 9U);
  EXPECT_EQ(mesh.positions[8], Position(2, 2, 2));
  ASSERT_EQ(mesh.normals.size(), 9U);
  EXPECT_EQ(mesh.normals[8], Normal(0, 0, 1));
}

TEST(Repair, TakesAllPairsOutOfEveryShape) {
  for (const Shape shape :
       {Shape::Sphere, Shape::Torus, Shape::Box, Shape::Bracket, Shape::Gyroid, Shape::Terrain}) {
    for (const double voxelSize : {0.02, 0.031}) {
      ContourReport report;
      const Mesh mesh = contourOf(shape, voxelSize, true, &report);
      const Mesh plain = contourOf(shape, voxelSize, false);
      const CheckReport checked = check(mesh), before = check(plain);
      const std::string name(shapeNames()[static_cast<std::size_t>(shape)]);
      EXPECT_EQ(checked.selfIntersectingPairs.value(), 0U) << name << " at " << voxelSize;
      EXPECT_EQ(report.intersectionsLeft, 0U);
      EXPECT_EQ(report.intersectionsFound == 0, before.selfIntersectingPairs.value() == 0);
      EXPECT_TRUE(checked.watertight());
      EXPECT_EQ(checked.eulerCharacteristic, before.eulerCharacteristic);
      EXPECT_EQ(checked.components.size(), before.components.size());
      EXPECT_EQ(mesh.positions.size(), plain.positions.size() + report.fannedQuads);
    }
  }
}

TEST(Repair, LeavesNoiseNearlyFreeOfPairs) {
  const auto grid = makeGrid(Shape::Noise, 0.04);
  ContourOptions options;
  options.uniform = true;
  ContourReport report;
  const CheckReport checked = check(contour(*grid, options, &report));
  EXPECT_GT(report.intersectionsFound, 100U);
  EXPECT_LE(checked.selfIntersectingPairs.value(), 10U);
  EXPECT_TRUE(checked.closed && checked.manifold && checked.oriented);
}

TEST(Repair, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const Shape shape : {Shape::Bracket, Shape::Gyroid}) {
    const auto grid = makeGrid(shape, 0.02);
    ContourOptions options;
    options.uniform = true;
    options.threads = 1;
    const Mesh one = contour(*grid, options);
    options.threads = 3;
    const Mesh three = contour(*grid, options);
    EXPECT_EQ(one.positions, three.positions);
    EXPECT_EQ(one.quads, three.quads);
    EXPECT_EQ(one.triangles, three.triangles);
    EXPECT_EQ(one.normals, three.normals);
  }
}

TEST(LonePieces, AreTurnedTheRightWayOut) {
  auto grid = openvdb::FloatGrid::create(1.0F);
  for (const openvdb::Coord& at : {openvdb::Coord(4, 4, 4), openvdb::Coord(20, 3, 9)}) {
    grid->tree().setValue(at, -0.5F);
  }
  ContourOptions options;
  options.isovalue = 0;
  options.inside = Inside::Below;
  options.uniform = true;
  const Mesh good = contour(*grid, options);
  ASSERT_EQ(good.quads.size(), 12U);
  Mesh mesh = good;
  const refine::Source source = sourceOf(good);
  base::Job job(0, {});
  EXPECT_EQ(refine::unfoldLoneComponents(mesh, refine::findLoneComponents(mesh, job), source), 0U);
  // One of them mirrored at a plane through it.
  std::size_t mirrored = 0;
  for (Position& p : mesh.positions) {
    if (p.x > 10) continue;
    p.x = 8 - p.x;
    ++mirrored;
  }
  ASSERT_EQ(mirrored, 8U);
  EXPECT_FALSE(check(mesh).outward);
  EXPECT_EQ(refine::unfoldLoneComponents(mesh, refine::findLoneComponents(mesh, job), source), 8U);
  EXPECT_EQ(mesh.positions, good.positions);
}

// A ring from which a thin shell is taken away leaves bubbles less than a voxel wide beside
// creases.
TEST(SmallPieces, StayOnTheirSideOfCreases) {
  const openvdb::Vec3d ring(15.9290, 18.5124, -4.27051), ball(11.8012, 14.1504, 2.24806);
  const openvdb::CoordBBox box(openvdb::Coord(-20, -20, -16), openvdb::Coord(50, 50, 14));
  const auto grid = test::levelSet<openvdb::FloatGrid>(box, 3, [&](const openvdb::Coord& at) {
    const openvdb::Vec3d from = at.asVec3d() - ring;
    const double tube = std::hypot(std::hypot(from[0], from[1]) - 19.9708, from[2]) - 4;
    const double shell = std::abs((at.asVec3d() - ball).length() - 21.8364) - 1;
    // Cut off by a cube, too.
    double distance = std::max(tube, -shell);
    for (int axis = 0; axis < 3; ++axis) {
      distance = std::max(distance, std::abs(static_cast<double>(at[axis])) - 41);
    }
    return distance;
  });
  ContourOptions options;
  options.uniform = true;
  const CheckReport report = check(contour(*grid, options));
  EXPECT_GT(report.components.size(), 1U);
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.selfIntersectingPairs, 0U);
  options.repair = false;
  EXPECT_FALSE(check(contour(*grid, options)).watertight()) << "is no example any more";
}

// What findCandidates() promises: every pair has a candidate.
TEST(Candidates, HaveAPartInEveryPair) {
  for (const Shape shape : {Shape::Noise, Shape::Gyroid, Shape::Bracket, Shape::Terrain}) {
    const auto grid = makeGrid(shape, 0.03);
    base::Job job(0, {});
    const ContourOptions options;
    uniform::UniformSurface uniform =
        uniform::makeUniformSurface(grid::openVolume(*grid, options, job), options, {}, job);
    const std::vector<std::uint32_t> candidates = intersect::findCandidates(
        uniform.view(), uniform.mesh, 1e-3 * uniform.affine().leastHeight(), job);
    const intersect::Surface surface(uniform.mesh, job);
    const auto all = intersect::findPairs(surface, allPolygons(uniform.mesh), job);
    EXPECT_FALSE(all.empty());
    EXPECT_EQ(intersect::findPairs(surface, candidates, job), all);
    EXPECT_LT(candidates.size(), uniform.mesh.quads.size());
  }
}

TEST(SinglePrecision, IsTakenUnlessItMovesTooFar) {
  Mesh mesh;
  mesh.positions = {{0.1, 0.2, 1000.3}, {-2000.7, 1e-9, 0}};
  const Mesh before = mesh;
  base::Job job(0, {});
  EXPECT_FALSE(base::roundToSingle(mesh, 1e-5, job));
  EXPECT_EQ(mesh.positions, before.positions);
  EXPECT_TRUE(base::roundToSingle(mesh, 1e-3, job));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Position& p = mesh.positions[i];
    const Position& q = before.positions[i];
    EXPECT_TRUE(p.x == static_cast<float>(q.x) && p.y == static_cast<float>(q.y) &&
                p.z == static_cast<float>(q.z));
  }
  EXPECT_NE(mesh.positions[1].x, before.positions[1].x);
}

}  // namespace
}  // namespace tufa
