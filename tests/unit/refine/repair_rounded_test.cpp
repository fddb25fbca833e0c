#include "refine/repair_rounded.h"

#include <gtest/gtest.h>
#include <tufa/shapes.h>

#include <numeric>
#include <utility>
#include <vector>

#include "base/job.h"
#include "refine/repair/repair.h"
#include "refine/rounding.h"
#include "refine/uniform_repair.h"
#include "support/shape.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {
namespace {

// As it is before any repair, so that there is much to do.
uniform::UniformSurface surfaceOf(const openvdb::FloatGrid& grid, base::Job& job) {
  return uniform::makeUniformSurface(grid::openVolume(grid, {}, job), {}, {}, job);
}

// What intersects in the mesh as it is written.
std::vector<intersect::PolygonPair> pairsOf(const uniform::UniformSurface& surface,
                                            base::Job& job) {
  Mesh world = surface.mesh;
  (void)takeToWorld(world, surface.affine(), job);
  std::vector<intersect::PolygonIndex> all(world.quads.size());
  std::iota(all.begin(), all.end(), intersect::PolygonIndex{0});
  const intersect::Surface index(world, job);
  return intersect::findPairs(index, all, job);
}

// The whole mesh in the place of the surroundings of pairs.
RepairReport repairWhole(uniform::UniformSurface& surface,
                         const std::vector<intersect::PolygonPair>& pairs, base::Job& job) {
  Mesh world = surface.mesh;
  Source source = sourceOf(surface, job);
  source.singlePrecision = takeToWorld(world, surface.affine(), job);
  source.massPoints = [&, points = source.massPoints](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> all = points(vertices);
    for (Position& point : all) point = surface.affine().toWorld(point);
    return all;
  };
  source.crossings = nullptr;
  RepairReport repaired =
      repairIntersections(world, intersect::distinctPolygonsOf(pairs), source, job);
  for (const auto& [vertex, from] : repaired.moved) {
    surface.mesh.positions[vertex] = surface.affine().fromWorld(world.positions[vertex]);
  }
  surface.mesh.quads = world.quads;
  return repaired;
}

TEST(RepairRounded, DoesInSurroundingsWhatItDoesInTheWhole) {
  base::Job job(1, {});
  for (const auto& [shape, voxelSize] : {std::pair(Shape::Gyroid, 0.02),
                                         {Shape::Bracket, 0.015},
                                         {Shape::Terrain, 0.012},
                                         {Shape::Noise, 0.06}}) {
    const auto grid = test::shapeOf(shape, voxelSize);
    uniform::UniformSurface some = surfaceOf(*grid, job), whole = surfaceOf(*grid, job);
    const std::vector<intersect::PolygonPair> pairs = pairsOf(some, job);
    ASSERT_FALSE(pairs.empty());
    ContourReport report;
    repairRounded(some, pairs, report, job);
    const RepairReport expected = repairWhole(whole, pairs, job);
    EXPECT_GT(expected.movedVertices + expected.flippedDiagonals, 0U);
    EXPECT_EQ(report.movedVertices, expected.movedVertices);
    EXPECT_EQ(report.flippedDiagonals, expected.flippedDiagonals);
    EXPECT_EQ(report.intersectionsLeft, expected.left.size());
    EXPECT_EQ(some.mesh.positions, whole.mesh.positions);
    EXPECT_EQ(some.mesh.quads, whole.mesh.quads);
    EXPECT_LT(report.intersectionsLeft, pairs.size());
  }
}

TEST(RepairRounded, LeavesAloneWhatDoesNotIntersect) {
  base::Job job(1, {});
  uniform::UniformSurface surface = surfaceOf(*test::shapeOf(Shape::Sphere, 0.05), job);
  const Mesh before = surface.mesh;
  ContourReport report;
  repairRounded(surface, {{3, 4}, {3, 500}}, report, job);
  EXPECT_EQ(surface.mesh.positions, before.positions);
  EXPECT_EQ(surface.mesh.quads, before.quads);
  EXPECT_EQ(report.movedVertices + report.intersectionsLeft, 0U);
}

}  // namespace
}  // namespace tufa::refine
