#include "refine/finish.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/mesh_oracle.h"
#include "support/model.h"

namespace tufa::refine {
namespace {

constexpr double kRadius = 7.3, kVoxelSize = 0.1;

// The uniform mesh of a ball that was moved along x, finished.
Mesh finished(const ContourOptions& options = {}, double moved = 0) {
  const auto grid = test::ballOf(kRadius, kVoxelSize);
  grid->transform().postTranslate(openvdb::Vec3d(moved, 0, 0));
  test::ModelOf model(grid, options);
  ExtractedMesh extracted;
  extracted.mesh = model.mesh();
  extracted.closePairs = model.model().closePairs();
  ContourReport report;
  finishMesh(model.model(), options, extracted, report, model.job());
  return std::move(extracted.mesh);
}

bool isSingle(const Position& p) {
  const auto same = [](double x) { return static_cast<double>(static_cast<float>(x)) == x; };
  return same(p.x) && same(p.y) && same(p.z);
}

TEST(FinishMesh, PutsPositionsIntoTheWorld) {
  for (const double moved : {0.0, -3.5, 100.0}) {
    for (const Position& p : finished({}, moved).positions) {
      EXPECT_NEAR((Vec3(p) - Vec3(moved, 0, 0)).length(), kRadius * kVoxelSize, 0.05 * kVoxelSize);
    }
  }
}

TEST(FinishMesh, RoundsToSinglePrecisionNearTheOrigin) {
  const Mesh mesh = finished();
  ASSERT_FALSE(mesh.positions.empty());
  for (const Position& p : mesh.positions) EXPECT_TRUE(isSingle(p));
}

// Where floats are a voxel apart.
TEST(FinishMesh, KeepsDoublePrecisionFarAway) {
  int doubles = 0;
  for (const Position& p : finished({}, 1e6).positions) {
    doubles += isSingle(p) ? 0 : 1;
    EXPECT_NEAR((Vec3(p) - Vec3(1e6, 0, 0)).length(), kRadius * kVoxelSize, 0.05 * kVoxelSize);
  }
  EXPECT_GT(doubles, 100);
}

TEST(FinishMesh, GivesTheNormalsThatWereAskedFor) {
  ContourOptions options;
  options.normals = Normals::None;
  EXPECT_TRUE(finished(options).normals.empty());
  for (const Normals normals : {Normals::Gradient, Normals::Faces}) {
    options.normals = normals;
    const Mesh mesh = finished(options);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
      const Vec3 outward = Vec3(mesh.positions[i]).unitOrX();
      EXPECT_GT(Vec3(mesh.normals[i]).dot(outward), 0.98);
      EXPECT_NEAR(Vec3(mesh.normals[i]).length(), 1, 1e-5);
    }
  }
}

TEST(FinishMesh, LeavesPolygonsAlone) {
  const test::ModelOf model(test::ballOf(kRadius, kVoxelSize));
  EXPECT_EQ(finished().quads, model.mesh().quads);
}

// Two quads pushed through each other; what comes from the uniform mesh may go back there.
TEST(FinishMesh, RepairsWhatStillIntersects) {
  const auto grid = test::ballOf(kRadius, kVoxelSize);
  test::ModelOf model(grid);
  ExtractedMesh extracted;
  extracted.mesh = model.mesh();
  const auto& corners = extracted.mesh.quads[50].vertices;
  // One corner far beyond the opposite one.
  const Vec3 a(extracted.mesh.positions[corners[0]]), c(extracted.mesh.positions[corners[2]]);
  extracted.mesh.positions[corners[0]] = c + (c - a) * 1.5;
  for (std::uint32_t i = 0; i < extracted.mesh.quads.size(); ++i) extracted.candidates.push_back(i);
  ContourOptions options;
  ContourReport report;
  ExtractedMesh untouched = extracted;
  finishMesh(model.model(), options, extracted, report, model.job());
  EXPECT_GT(report.movedVertices + report.flippedDiagonals + report.fannedQuads, 0U);
  EXPECT_EQ(report.intersectionsLeft, 0U);
  options.repair = false;
  ContourReport none;
  finishMesh(model.model(), options, untouched, none, model.job());
  EXPECT_EQ(none.movedVertices + none.flippedDiagonals + none.fannedQuads, 0U);
}

}  // namespace
}  // namespace tufa::refine
