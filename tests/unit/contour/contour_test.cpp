// What contour() promises of its options, its report and its errors.

#include <tufa/contour.h>

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/shapes.h>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "base/vec3.h"
#include "support/expect_error.h"
#include "support/fields.h"
#include "support/mesh_oracle.h"
#include "support/uniform_mesh.h"

namespace tufa {
namespace {

using openvdb::CoordBBox;
using openvdb::DoubleGrid;
using openvdb::FloatGrid;
using openvdb::Vec3d;
using test::expectError;

constexpr double kPi = 3.14159265358979;

template <class GridT = FloatGrid>
typename GridT::Ptr ball(double radius = 10, double halfWidth = 3) {
  const int reach = static_cast<int>(radius + halfWidth) + 1;
  return test::levelSet<GridT>(CoordBBox(openvdb::Coord(-reach), openvdb::Coord(reach)), halfWidth,
                               [&](const openvdb::Coord& at) {
                                 return (at.asVec3d() - Vec3d(0.3, 0.2, 0.1)).length() - radius;
                               });
}

/// A closed, oriented manifold whose normals look out.
void expectSolid(const Mesh& mesh, const char* what = "") {
  const test::MeshTopology topology = test::inspect(mesh);
  EXPECT_TRUE(topology.manifold()) << what << " " << topology;
  EXPECT_TRUE(topology.closed()) << what << " " << topology;
  EXPECT_GT(test::volume(mesh), 0) << what;
}

TEST(Contour, ReportsWhatItDid) {
  const auto grid = ball();
  ContourReport report;
  const Mesh mesh = tufa::test::uniformMesh(*grid, {}, &report);
  expectSolid(mesh);
  EXPECT_EQ(report.isovalue, 0);
  EXPECT_TRUE(report.insideIsBelow);
  EXPECT_TRUE(report.distanceField);
  EXPECT_EQ(report.activeVoxels, grid->activeVoxelCount());
  EXPECT_EQ(report.surfaceCells, mesh.positions.size());  // no ambiguous cell on a ball
  EXPECT_EQ(report.faceFlips, 0U);
  EXPECT_EQ(report.openEdges, 0U);
  EXPECT_EQ(report.nonFiniteValues, 0U);
  std::set<std::string> stages;
  for (const StageTime& stage : report.stages) {
    EXPECT_GE(stage.seconds, 0);
    stages.insert(stage.stage);
  }
  for (const char* stage : {"blocks", "topology", "vertices", "polygons", "creases"}) {
    EXPECT_TRUE(stages.count(stage)) << stage;
  }
}

TEST(Contour, FindsTheIsovalueAndTheInsideByTheClass) {
  auto grid = ball();
  for (auto value = grid->beginValueAll(); value; ++value) value.setValue(1 - *value / 3);
  grid->tree().root().setBackground(0, false);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  ContourReport report;
  expectSolid(tufa::test::uniformMesh(*grid, {}, &report));
  EXPECT_NEAR(report.isovalue, 1, 0.01);
  EXPECT_FALSE(report.insideIsBelow);
  grid->setGridClass(openvdb::GRID_UNKNOWN);  // the background is low, so inside is above
  expectSolid(tufa::test::uniformMesh(*grid, {}, &report));
  EXPECT_FALSE(report.insideIsBelow);
}

TEST(Contour, MeshesAnyIsovalue) {
  for (const double isovalue : {-1.2, -0.5, 0.0, 1.0, 1.5}) {
    ContourOptions options;
    options.isovalue = isovalue;
    const Mesh mesh = tufa::test::uniformMesh(*ball(), options);
    expectSolid(mesh);
    const double truth = 4 * kPi / 3 * std::pow(10 + isovalue, 3);
    EXPECT_NEAR(test::volume(mesh) / truth, 1, 0.01) << isovalue;
  }
}

// Densities are of any size: permeabilities are of 1e-12.
TEST(Contour, GradientsOfAnySizeCount) {
  const auto meshOf = [](double size, bool uniform) {
    const auto grid = FloatGrid::create(0);
    for (const openvdb::Coord& at : CoordBBox(openvdb::Coord(-15), openvdb::Coord(15))) {
      const double away = (at.asVec3d() - Vec3d(0.3, 0.2, 0.1)).length() - 10;
      grid->tree().setValue(at, static_cast<float>(size / (1 + std::exp(away / 1.5))));
    }
    ContourOptions options;
    options.isovalue = 0.5 * size;
    options.uniform = uniform;
    return contour(*grid, options);
  };
  const Mesh one = meshOf(1, true);
  for (const double size : {1e-6, 1e-12, 1e-17, 1e12}) {
    const Mesh mesh = meshOf(size, true);
    ASSERT_EQ(mesh.positions.size(), one.positions.size()) << size;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      ASSERT_LT((Vec3(mesh.positions[v]) - Vec3(one.positions[v])).length(), 1e-3) << size;
      ASSERT_GT(Vec3(mesh.normals[v]).dot(Vec3(one.normals[v])), 0.9999) << size;
    }
    EXPECT_NEAR(static_cast<double>(meshOf(size, false).triangleCount()),
                static_cast<double>(meshOf(1, false).triangleCount()), 30)
        << size;
  }
}

TEST(Contour, InsideAboveTurnsTheSurfaceAround) {
  ContourOptions options;
  options.inside = Inside::Above;
  const Mesh mesh = tufa::test::uniformMesh(*ball(), options);
  EXPECT_TRUE(test::inspect(mesh).manifold());
  EXPECT_NEAR(test::volume(mesh), -test::volume(tufa::test::uniformMesh(*ball())), 1e-6 * 4189);
}

TEST(Contour, NormalsAreThoseAskedFor) {
  const auto grid = ball(20);
  ContourOptions options;
  for (const Normals normals : {Normals::Gradient, Normals::Faces}) {
    options.normals = normals;
    const Mesh mesh = tufa::test::uniformMesh(*grid, options);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
      const Position& p = mesh.positions[v];
      const Vec3d truth = (Vec3d(p.x, p.y, p.z) - Vec3d(0.3, 0.2, 0.1)).unit();
      const Normal& n = mesh.normals[v];
      ASSERT_GT(truth.dot(Vec3d(n.x, n.y, n.z)), normals == Normals::Gradient ? 0.9995 : 0.995);
    }
  }
  options.normals = Normals::None;
  EXPECT_TRUE(tufa::test::uniformMesh(*grid, options).normals.empty());
  const Mesh plain = tufa::test::uniformMesh(*grid, options);
  EXPECT_EQ(plain.positions, tufa::test::uniformMesh(*grid).positions);
}

// In noise gradients cancel, and repair looks at normals.
TEST(Contour, NormalsHaveLength1AndLeaveTheMeshAsItIs) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    test::NoiseOptions noise;
    noise.seed = seed;
    noise.size = 24;
    const auto grid = test::noise<FloatGrid>(noise);
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    ContourOptions options;
    options.isovalue = 0;
    const Mesh first = tufa::test::uniformMesh(*grid, options);
    for (const Normals normals : {Normals::Gradient, Normals::Faces, Normals::None}) {
      options.normals = normals;
      const Mesh mesh = tufa::test::uniformMesh(*grid, options);
      EXPECT_EQ(mesh.positions, first.positions);
      EXPECT_EQ(mesh.quads, first.quads);
      EXPECT_EQ(mesh.triangles, first.triangles);
      for (const Normal& n : mesh.normals) ASSERT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-4);
    }
  }
}

TEST(Contour, NothingInGivesNothingOut) {
  ContourReport report;
  report.faceFlips = 7;
  const Mesh mesh = tufa::test::uniformMesh(*FloatGrid::create(3), {}, &report);
  EXPECT_TRUE(mesh.positions.empty() && mesh.quads.empty() && mesh.triangles.empty());
  EXPECT_EQ(report.surfaceCells + report.activeVoxels + report.faceFlips, 0U);
  ContourOptions options;
  options.isovalue = 100;  // past every value
  EXPECT_EQ(tufa::test::uniformMesh(*ball(), options).triangleCount(), 0U);
  EXPECT_EQ(tufa::test::uniformMesh(*DoubleGrid::create(-1)).triangleCount(), 0U);
}

TEST(Contour, DoubleGridsGiveTheSameMesh) {
  const auto grid = ball();
  auto twin = DoubleGrid::create(grid->background());
  twin->tree().topologyUnion(grid->tree());
  for (auto value = grid->cbeginValueAll(); value; ++value) {
    if (value.isVoxelValue()) twin->tree().setValueOnly(value.getCoord(), *value);
  }
  twin->setGridClass(openvdb::GRID_LEVEL_SET);
  const Mesh ofFloat = tufa::test::uniformMesh(*grid), ofDouble = tufa::test::uniformMesh(*twin);
  EXPECT_EQ(ofFloat.quads, ofDouble.quads);
  ASSERT_EQ(ofFloat.positions.size(), ofDouble.positions.size());
  for (std::size_t v = 0; v < ofFloat.positions.size(); ++v) {
    const Position &a = ofFloat.positions[v], &b = ofDouble.positions[v];
    EXPECT_LT(std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}), 1e-5);
  }
}

TEST(Contour, SamplesOnTheIsovalueDoNotHarm) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const auto grid = test::noise<FloatGrid>({.size = 24, .seed = seed, .wholeNumbers = true});
    for (const double isovalue : {-1.0, 0.0, 1.0}) {
      for (const Inside inside : {Inside::Below, Inside::Above}) {
        ContourOptions options;
        options.isovalue = isovalue;
        options.inside = inside;
        const test::MeshTopology topology = test::inspect(tufa::test::uniformMesh(*grid, options));
        EXPECT_TRUE(topology.manifold() && topology.closed()) << isovalue << " " << topology;
      }
    }
  }
}

TEST(Contour, RefusesNonFiniteValuesWithTheirCountAndFirstPlace) {
  auto grid = ball();
  grid->tree().setValue(openvdb::Coord(5, 0, 7), std::numeric_limits<float>::quiet_NaN());
  grid->tree().setValue(openvdb::Coord(-4, 2, 7), std::numeric_limits<float>::infinity());
  expectError(ErrorCode::NonFiniteValues, "2 ", [&] { (void)tufa::test::uniformMesh(*grid); });
  expectError(ErrorCode::NonFiniteValues, "-4, 2, 7",
              [&] { (void)tufa::test::uniformMesh(*grid); });
  ContourOptions options;
  options.nonFinite = NonFinite::Outside;
  ContourReport report;
  const Mesh mesh = tufa::test::uniformMesh(*grid, options, &report);
  EXPECT_EQ(report.nonFiniteValues, 2U);
  expectSolid(mesh);
  for (const Position& p : mesh.positions) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
  for (const Normal& n : mesh.normals) EXPECT_TRUE(std::isfinite(n.x + n.y + n.z));
}

TEST(Contour, RefusesWhatHasNoSurface) {
  expectError(ErrorCode::UnsupportedGrid, "vec3s",
              [] { (void)tufa::test::uniformMesh(*openvdb::Vec3SGrid::create()); });
  expectError(ErrorCode::UnsupportedGrid, "bool",
              [] { (void)tufa::test::uniformMesh(*openvdb::BoolGrid::create()); });
  expectError(ErrorCode::UnsupportedGrid, "int32",
              [] { (void)tufa::test::uniformMesh(*openvdb::Int32Grid::create()); });
  auto frustum = ball();
  frustum->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(Vec3d(0), Vec3d(10)), 0.5, 10, 1));
  expectError(ErrorCode::UnsupportedGrid, "rustum",
              [&] { (void)tufa::test::uniformMesh(*frustum); });
  ContourOptions options;
  options.isovalue = std::numeric_limits<double>::infinity();
  expectError(ErrorCode::InvalidArgument, "isovalue",
              [&] { (void)tufa::test::uniformMesh(*ball(), options); });
  options = {};
  options.threads = -1;
  expectError(ErrorCode::InvalidArgument, "threads",
              [&] { (void)tufa::test::uniformMesh(*ball(), options); });
}

TEST(Contour, ProgressRisesToOneAndCancelsAnywhere) {
  const auto grid = ball(30);
  ContourOptions options;
  double last = 0;
  int calls = 0;
  options.progress = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
    ++calls;
    return true;
  };
  (void)tufa::test::uniformMesh(*grid, options);
  EXPECT_EQ(last, 1);
  ASSERT_GE(calls, 6);
  for (int stop = 1; stop <= 6; ++stop) {
    int seen = 0;
    options.progress = [&](std::string_view, double) { return ++seen < stop; };
    expectError(ErrorCode::Cancelled, "cancelled",
                [&] { (void)tufa::test::uniformMesh(*grid, options); });
  }
}

TEST(Contour, CutsTheSurfaceWhereALevelSetEndsOrCapsIt) {
  // The half of a ball's band that is kept knows nothing of the other half.
  const auto grid = ball();
  auto half = FloatGrid::create(grid->background());
  half->setGridClass(openvdb::GRID_LEVEL_SET);
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    if (value.getCoord().z() < 3) half->tree().setValueOn(value.getCoord(), *value);
  }
  for (auto value = grid->cbeginValueOff(); value; ++value) {
    if (value.isVoxelValue() && value.getCoord().z() < 3) {
      half->tree().setValueOff(value.getCoord(), *value);
    }
  }
  ContourReport report;
  const Mesh open = tufa::test::uniformMesh(*half, {}, &report);
  EXPECT_GT(report.openEdges, 0U);
  test::MeshTopology topology = test::inspect(open);
  EXPECT_TRUE(topology.manifold()) << topology;
  EXPECT_GT(topology.boundaryEdges, 0U);
  for (const Position& p : open.positions) EXPECT_LE(p.z, 3);

  ContourOptions options;
  options.cap = true;
  const Mesh capped = tufa::test::uniformMesh(*half, options, &report);
  EXPECT_EQ(report.openEdges, 0U);
  topology = test::inspect(capped);
  EXPECT_TRUE(topology.manifold() && topology.closed()) << topology;
  EXPECT_GT(test::volume(capped), test::volume(tufa::test::uniformMesh(*grid)) / 2);
}

}  // namespace
}  // namespace tufa
