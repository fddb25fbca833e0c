// Tolerances that differ from place to place: ContourOptions::toleranceGrid.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <tufa/lod.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <limits>

#include "support/mesh_oracle.h"

namespace tufa {
namespace {

using openvdb::FloatGrid;

constexpr double kVoxel = 0.04;

FloatGrid::Ptr bracket() {
  ShapeOptions options;
  options.voxelSize = kVoxel;
  return openvdb::gridPtrCast<FloatGrid>(makeShape(Shape::Bracket, options));
}

// `scaleAt` for each place of its lattice that has a voxel.
template <class ScaleAt>
FloatGrid::Ptr scalesFor(const FloatGrid& grid, const ScaleAt& scaleAt) {
  const auto scales = FloatGrid::create(1);
  scales->setTransform(grid.transform().copy());
  auto accessor = scales->getAccessor();
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
    accessor.setValue(voxel.getCoord(), static_cast<float>(scaleAt(voxel.getCoord())));
  }
  return scales;
}

TEST(ToleranceGrids, OfOneValueMultiplyTheTolerance) {
  const auto grid = bracket();
  for (const double scale : {0.1, 2.0, 16.0}) {
    ContourOptions scaled, plain;
    scaled.toleranceGrid = FloatGrid::create(static_cast<float>(scale));
    plain.tolerance = scaled.tolerance * static_cast<double>(static_cast<float>(scale));
    ContourReport report, ofPlain;
    const Mesh mesh = contour(*grid, scaled, &report);
    EXPECT_TRUE(test::sameBytes(mesh, contour(*grid, plain, &ofPlain))) << scale;
    EXPECT_LE(report.certificate->maxErrorVoxels, plain.tolerance * 1.001) << scale;
    EXPECT_EQ(report.certificate->rounds, ofPlain.certificate->rounds) << scale;
    scaled.simplify = false;
    plain.simplify = false;
    EXPECT_TRUE(test::sameBytes(contour(*grid, scaled), contour(*grid, plain))) << scale;
  }
}

// Both sides of a step keep their own tolerance, and lose about as many triangles as with one.
TEST(ToleranceGrids, HoldOnBothSidesOfAStep) {
  const auto grid = bracket();
  ContourOptions fine, coarse, both;
  fine.tolerance = 0.05;
  coarse.tolerance = 1;
  both.tolerance = 0.1;
  both.toleranceGrid =
      scalesFor(*grid, [](const openvdb::Coord& at) { return at[0] < 0 ? 0.5 : 10; });
  const Mesh ofFine = contour(*grid, fine), ofCoarse = contour(*grid, coarse);
  ContourReport report;
  const Mesh mesh = contour(*grid, both, &report);
  EXPECT_LE(report.certificate->maxErrorVoxels, 1.001);
  EXPECT_GT(report.certificate->maxErrorVoxels, 0.1);
  const test::MeshTopology topology = test::inspect(mesh);
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  const auto onSide = [](const Mesh& of, double side) {
    return std::count_if(of.triangles.begin(), of.triangles.end(), [&](const Triangle& t) {
      double sum = 0;
      for (const VertexIndex v : t.vertices) sum += of.positions[v].x;
      return sum * side > 0;
    });
  };
  EXPECT_LT(onSide(mesh, -1), 1.25 * static_cast<double>(onSide(ofFine, -1)) + 20);
  EXPECT_LT(onSide(mesh, 1), 1.5 * static_cast<double>(onSide(ofCoarse, 1)) + 40);
}

TEST(ToleranceGrids, HoldWhereTheScaleRises) {
  const auto grid = bracket();
  const auto box = grid->evalActiveVoxelBoundingBox();
  ContourOptions options;
  options.toleranceGrid = scalesFor(*grid, [&](const openvdb::Coord& at) {
    return 0.2 + 5.0 * (at[0] - box.min()[0]) / box.extents()[0];
  });
  ContourReport report;
  const Mesh mesh = contour(*grid, options, &report);
  EXPECT_LE(report.certificate->maxErrorVoxels, 0.521);
  EXPECT_LE(report.certificate->rounds, 3);
  options.toleranceGrid.reset();
  EXPECT_LT(mesh.triangles.size(), contour(*grid, options).triangles.size());
}

// As a mask for "as few as you like" may have them.
TEST(ToleranceGrids, MayHaveAnyValues) {
  const auto grid = bracket();
  for (const double most : {1e4, 1e30}) {
    ContourOptions options;
    options.toleranceGrid = scalesFor(*grid, [&](const openvdb::Coord& at) {
      return at[0] < 0 ? 1 : at[1] < 0 ? -1 : most;
    });
    ContourReport report;
    const Mesh mesh = contour(*grid, options, &report);
    const test::MeshTopology topology = test::inspect(mesh);
    EXPECT_TRUE(topology.manifold() && topology.closed()) << most << " " << topology;
    EXPECT_EQ(report.intersectionsLeft, 0U) << most;
  }
}

// Infinity was taken for the finest level.
TEST(ToleranceGrids, TakeInfinityForTheLargestValue) {
  const auto grid = bracket();
  const auto meshWith = [&](float value) {
    ContourOptions options;
    options.toleranceGrid =
        scalesFor(*grid, [&](const openvdb::Coord& at) { return at[0] < 0 ? 1 : value; });
    return contour(*grid, options);
  };
  using Limits = std::numeric_limits<float>;
  const Mesh coarse = meshWith(Limits::infinity());
  const Mesh fine = meshWith(Limits::quiet_NaN());
  EXPECT_TRUE(test::sameBytes(coarse, meshWith(Limits::max())));
  EXPECT_TRUE(test::sameBytes(fine, meshWith(0)));
  EXPECT_TRUE(test::sameBytes(fine, meshWith(-Limits::infinity())));
  EXPECT_LT(coarse.triangleCount(), fine.triangleCount() / 2);
}

TEST(ToleranceGrids, HoldForBudgets) {
  const auto grid = bracket();
  LodOptions options;
  options.triangles = {600};
  options.contour.toleranceGrid =
      scalesFor(*grid, [](const openvdb::Coord& at) { return at[0] < 0 ? 1 : 8; });
  const LodChain chain = buildLods(*grid, options);
  ASSERT_EQ(chain.levels.size(), 1U);
  EXPECT_LE(chain.levels[0].mesh.triangles.size(), 600U);
  EXPECT_GE(chain.levels[0].mesh.triangles.size(), 570U);
}

}  // namespace
}  // namespace tufa
