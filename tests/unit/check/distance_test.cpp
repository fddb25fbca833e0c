#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>

#include <tufa/check.h>
#include <tufa/error.h>
#include <cmath>
#include <limits>

#include "unit/check/meshes.h"

namespace tufa {
namespace {

constexpr double kRadius = 20;  // voxels

openvdb::FloatGrid::Ptr sphereGrid(double voxelSize = 1) {
  return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      static_cast<float>(kRadius * voxelSize), openvdb::Vec3f(0), static_cast<float>(voxelSize));
}

Mesh scaled(Mesh mesh, double sx, double sy, double sz) {
  for (Position& p : mesh.positions) p = Position(p.x * sx, p.y * sy, p.z * sz);
  return mesh;
}

/// Near its surface the distance to a sphere of radius R curves by 1/R in two directions, so its
/// trilinear interpolant is off by up to 1/(4R) = 0.0125 voxel. The facets of the meshes add some.
constexpr double kSphereTolerance = 0.03;

TEST(CheckDistance, FineSphereIsOnItsLevelSet) {
  const DistanceReport report = checkAgainst(test::sphere(kRadius, 6), *sphereGrid());
  EXPECT_EQ(report.isovalue, 0);
  EXPECT_DOUBLE_EQ(report.voxelSize, 1);
  // Vertices once, and for each triangle three middles of edges and the centre.
  EXPECT_EQ(report.meshToSurface.samples, 16386U + 4 * 32768U);
  EXPECT_GT(report.surfaceToMesh.samples, 10000U);
  EXPECT_GT(report.meshToSurface.largest, 0);
  EXPECT_LT(report.meshToSurface.largest, kSphereTolerance);
  EXPECT_LT(report.surfaceToMesh.largest, kSphereTolerance);
}

TEST(CheckDistance, OffsetSphereIsAsFarAsItWasMoved) {
  for (const double offset : {-1.5, -0.2, 0.2, 1.0, 2.0}) {
    const DistanceReport report = checkAgainst(test::sphere(kRadius + offset, 6), *sphereGrid());
    for (const DistanceSummary& side : {report.meshToSurface, report.surfaceToMesh}) {
      EXPECT_NEAR(side.mean, std::abs(offset), kSphereTolerance) << offset;
      EXPECT_NEAR(side.rms, std::abs(offset), kSphereTolerance) << offset;
      EXPECT_NEAR(side.largest, std::abs(offset), 2 * kSphereTolerance) << offset;
    }
  }
}

// Cells with a sample that is not active were left out, and half the isosurface with them.
TEST(CheckDistance, IsovaluesNearTheEndOfTheBandAreMeasuredTo) {
  for (const double isovalue : {-2.0, 1.5, 2.0}) {
    const DistanceReport report =
        checkAgainst(test::sphere(kRadius + isovalue, 6), *sphereGrid(), {.isovalue = isovalue});
    EXPECT_LT(report.meshToSurface.largest, kSphereTolerance) << isovalue;
    EXPECT_LT(report.surfaceToMesh.largest, kSphereTolerance) << isovalue;
  }
}

TEST(CheckDistance, SamplesOutsideTheBandAreMeasuredToo) {
  // Far inside and far outside there is no gradient to follow.
  for (const double offset : {-12.0, 25.0}) {
    const DistanceReport report = checkAgainst(test::sphere(kRadius + offset, 5), *sphereGrid());
    EXPECT_NEAR(report.meshToSurface.mean, std::abs(offset), 0.05);
    EXPECT_NEAR(report.meshToSurface.largest, std::abs(offset), 0.1);
    EXPECT_NEAR(report.surfaceToMesh.mean, std::abs(offset), 0.1);
  }
}

// Doubles are 1.5e-8 apart there, and Newton steps were to end nearer to the surface than that: the
// distances were those to samples of it, up to half a voxel.
TEST(CheckDistance, HoldsFarFromTheOrigin) {
  const auto near = sphereGrid();
  constexpr int kAway = 100'000'000;
  const auto far = openvdb::FloatGrid::create(near->background());
  far->setGridClass(openvdb::GRID_LEVEL_SET);
  auto accessor = far->getAccessor();
  for (auto voxel = near->cbeginValueOn(); voxel; ++voxel) {
    accessor.setValue(voxel.getCoord().offsetBy(kAway, -kAway, kAway), *voxel);
  }
  for (const double offset : {0.0, 0.2}) {
    Mesh mesh = test::sphere(kRadius + offset, 5);
    const DistanceReport here = checkAgainst(mesh, *near);
    for (Position& p : mesh.positions) p = {p.x + kAway, p.y - kAway, p.z + kAway};
    const DistanceReport there = checkAgainst(mesh, *far);
    EXPECT_NEAR(there.meshToSurface.largest, here.meshToSurface.largest, 1e-5);
    EXPECT_NEAR(there.meshToSurface.mean, here.meshToSurface.mean, 1e-5);
    EXPECT_NEAR(there.surfaceToMesh.largest, here.surfaceToMesh.largest, 1e-5);
  }
}

TEST(CheckDistance, VoxelSizeScalesOut) {
  const double voxelSize = 1e-3;
  const DistanceReport report =
      checkAgainst(test::sphere((kRadius + 0.5) * voxelSize, 6), *sphereGrid(voxelSize));
  EXPECT_NEAR(report.voxelSize, voxelSize, 1e-9);  // the transform holds the float
  EXPECT_NEAR(report.meshToSurface.mean, 0.5, kSphereTolerance);
  EXPECT_NEAR(report.surfaceToMesh.mean, 0.5, kSphereTolerance);
}

TEST(CheckDistance, AnisotropicTransform) {
  // Stretched by 4 along x and 2 along z the voxel has volume 8: distances count lengths of 2.
  openvdb::FloatGrid::Ptr grid = sphereGrid();
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
  matrix.preScale(openvdb::Vec3d(4, 1, 2));
  matrix.postTranslate(openvdb::Vec3d(100, 0, -7));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  Mesh mesh = scaled(test::sphere(kRadius, 6), 4, 1, 2);
  for (Position& p : mesh.positions) p = Position(p.x + 100, p.y, p.z - 7);
  DistanceReport report = checkAgainst(mesh, *grid);
  EXPECT_NEAR(report.voxelSize, 2, 1e-12);
  EXPECT_LT(report.meshToSurface.largest, 2 * kSphereTolerance);
  EXPECT_LT(report.surfaceToMesh.largest, 2 * kSphereTolerance);

  // Moved by 2 along x, which is one voxel: the tips are that far off, and nothing is further.
  for (Position& p : mesh.positions) p.x += 2;
  report = checkAgainst(mesh, *grid);
  EXPECT_NEAR(report.meshToSurface.largest, 1, 2 * kSphereTolerance);
  EXPECT_NEAR(report.surfaceToMesh.largest, 1, 2 * kSphereTolerance);
}

TEST(CheckDistance, MissingPartShowsOnOneSideOnly) {
  Mesh mesh = test::sphere(kRadius, 6);
  std::erase_if(mesh.triangles,
                [&](const Triangle& t) { return mesh.positions[t.vertices[0]].z > 10; });
  const DistanceReport report = checkAgainst(mesh, *sphereGrid());
  EXPECT_LT(report.meshToSurface.largest, kSphereTolerance);
  EXPECT_GT(report.surfaceToMesh.largest, 10);
}

TEST(CheckDistance, FogVolumeUsesItsMiddleValueAndBothKindsOfNeighbour) {
  openvdb::FloatGrid grid(0);
  grid.setGridClass(openvdb::GRID_FOG_VOLUME);
  // A box of tiles and leaves: density 1 inside, nothing outside.
  grid.fill(openvdb::CoordBBox(openvdb::Coord(-8, -8, -8), openvdb::Coord(15, 11, 9)), 1.0f);
  const Mesh mesh = test::box(Position(-8.5, -8.5, -8.5), Position(15.5, 11.5, 9.5));
  const DistanceReport report = checkAgainst(mesh, grid);
  EXPECT_DOUBLE_EQ(report.isovalue, 0.5);
  // One crossing for each lattice edge through the faces of a box of 24 x 20 x 18 voxels.
  EXPECT_GE(report.surfaceToMesh.samples, 2 * (24U * 20 + 20 * 18 + 18 * 24));
  // The isosurface rounds the box's edges and corners, so the box is off there, and only there.
  EXPECT_LT(report.surfaceToMesh.mean, 0.02);
  EXPECT_LT(report.meshToSurface.largest, 0.55);
}

TEST(CheckDistance, DoubleGridGivesTheSame) {
  const openvdb::FloatGrid::Ptr grid = sphereGrid();
  const openvdb::DoubleGrid wide(*grid);
  const Mesh mesh = test::sphere(kRadius, 4);
  EXPECT_EQ(checkAgainst(mesh, *grid).meshToSurface.rms,
            checkAgainst(mesh, wide).meshToSurface.rms);
}

TEST(CheckDistance, ResultDoesNotDependOnThreads) {
  const openvdb::FloatGrid::Ptr grid = sphereGrid();
  const Mesh mesh = test::sphere(kRadius + 0.1, 5);
  const DistanceReport one = checkAgainst(mesh, *grid, {.threads = 1});
  const DistanceReport two = checkAgainst(mesh, *grid, {.threads = 2});
  EXPECT_EQ(one.meshToSurface.mean, two.meshToSurface.mean);
  EXPECT_EQ(one.meshToSurface.rms, two.meshToSurface.rms);
  EXPECT_EQ(one.surfaceToMesh.mean, two.surfaceToMesh.mean);
  EXPECT_EQ(one.surfaceToMesh.largest, two.surfaceToMesh.largest);
}

TEST(CheckDistance, NothingToMeasureToIsInfinite) {
  const DistanceReport noMesh = checkAgainst(Mesh{}, *sphereGrid());
  EXPECT_EQ(noMesh.meshToSurface.samples, 0U);
  EXPECT_EQ(noMesh.surfaceToMesh.largest, std::numeric_limits<double>::infinity());
  const openvdb::FloatGrid empty(1);
  const DistanceReport noSurface = checkAgainst(test::sphere(1, 1), empty);
  EXPECT_EQ(noSurface.surfaceToMesh.samples, 0U);
  EXPECT_EQ(noSurface.meshToSurface.largest, std::numeric_limits<double>::infinity());
  EXPECT_EQ(noSurface.meshToSurface.mean, std::numeric_limits<double>::infinity());
}

TEST(CheckDistance, BrokenMeshAndSamplesAreTakenWithoutHarm) {
  openvdb::FloatGrid::Ptr grid = sphereGrid();
  grid->getAccessor().setValue(openvdb::Coord(20, 0, 0), std::numeric_limits<float>::quiet_NaN());
  Mesh mesh = test::sphere(kRadius, 5);
  mesh.positions.emplace_back(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  mesh.triangles.emplace_back(0, 1, static_cast<VertexIndex>(mesh.positions.size() - 1));
  mesh.triangles.emplace_back(0, 1, 999999);
  mesh.triangles.emplace_back(3, 3, 3);
  const DistanceReport report = checkAgainst(mesh, *grid);
  EXPECT_LT(report.meshToSurface.mean, kSphereTolerance);
  EXPECT_LT(report.surfaceToMesh.largest, 0.1);
}

TEST(CheckDistance, RefusesWhatHasNoIsosurface) {
  const auto codeOf = [](const openvdb::GridBase& grid, const DistanceOptions& options) {
    try {
      static_cast<void>(checkAgainst(Mesh{}, grid, options));
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::UnwritableFile;
  };
  EXPECT_EQ(codeOf(openvdb::Int32Grid(), {}), ErrorCode::UnsupportedGrid);
  openvdb::FloatGrid frustum;
  frustum.setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 10));
  EXPECT_EQ(codeOf(frustum, {}), ErrorCode::UnsupportedGrid);
  for (const int samples : {1, 1001}) {
    EXPECT_EQ(codeOf(*sphereGrid(), {.samplesPerEdge = samples}), ErrorCode::InvalidArgument);
  }
  openvdb::FloatGrid tile;
  tile.tree().addTile(3, openvdb::Coord(0), 1, true);
  EXPECT_EQ(codeOf(tile, {}), ErrorCode::LimitExceeded);
  EXPECT_EQ(codeOf(openvdb::FloatGrid(std::nanf("")), {}), ErrorCode::NonFiniteValues);
  EXPECT_EQ(codeOf(*sphereGrid(), {.threads = -2}), ErrorCode::InvalidArgument);
  EXPECT_EQ(codeOf(*sphereGrid(), {.isovalue = std::nan("")}), ErrorCode::InvalidArgument);
  EXPECT_EQ(codeOf(*sphereGrid(), {.progress = [](auto, double) { return false; }}),
            ErrorCode::Cancelled);
}

}  // namespace
}  // namespace tufa
