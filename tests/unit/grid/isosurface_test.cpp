#include "grid/isosurface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "grid/vdb_coord.h"
#include "support/expect_error.h"
#include "support/fields.h"
#include "support/print.h"

namespace tufa::grid {
namespace {

using openvdb::FloatGrid;

constexpr IsoChoice kBelowZero{0, true};

// A field whose trilinear interpolant is the plane itself.
FloatGrid::Ptr plane(const Vec3& normal, double offset) {
  return test::sampled<FloatGrid>(
      {openvdb::Coord(-6), openvdb::Coord(6)}, 9,
      [&](const openvdb::Coord& at) { return normal.dot(Vec3(fromVdb(at))) - offset; });
}

TEST(VoxelFrame, MeasuresInVoxelsWhateverTheTransform) {
  const auto grid = FloatGrid::create(1);
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix.preScale(openvdb::Vec3d(1, 2, 4));
  matrix.postTranslate(openvdb::Vec3d(100, 0, -7));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  const VoxelFrame frame(*grid);
  EXPECT_DOUBLE_EQ(frame.voxelSize(), 2);
  // The same point, by its index and by its place in the world.
  const Vec3 index(3, -5, 0.5), world(103, -10, -5);
  EXPECT_LT((frame.fromIndex(index) - Vec3(1.5, -5, 1)).length(), 1e-12);
  EXPECT_LT((frame.fromWorld(world) - Vec3(1.5, -5, 1)).length(), 1e-12);
  EXPECT_LT((frame.toIndex(frame.fromIndex(index)) - index).length(), 1e-12);
  // A field that rises by 1 from index to index along z rises by that in two voxels.
  EXPECT_LT((frame.gradientFromIndex(Vec3(0, 0, 1)) - Vec3(0, 0, 0.5)).length(), 1e-12);
}

TEST(VoxelFrame, OfNoGridIsTheWorld) {
  const VoxelFrame frame;
  EXPECT_EQ(frame.voxelSize(), 1);
  EXPECT_EQ(frame.fromWorld(Position(1, 2, 3)), Vec3(1, 2, 3));
  EXPECT_EQ(frame.toIndex(Vec3(1, 2, 3)), Vec3(1, 2, 3));
}

TEST(VoxelFrame, RefusesFrustums) {
  const auto grid = FloatGrid::create(1);
  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(10)), 0.5, 1.0));
  test::expectError(ErrorCode::UnsupportedGrid, "", [&] { (void)VoxelFrame(*grid); });
}

TEST(Isosurface, OfAPlaneHasAllItsSamplesOnIt) {
  const Vec3 normal = Vec3(1, 2, -2) / 3;
  const auto grid = plane(normal, 0.4);
  const VoxelFrame frame(*grid);
  base::Job job(2, {});
  int inner = 0;
  for (const Vec3& point : isosurfaceOf(*grid, frame, kBelowZero)->samples(job)) {
    // Around the box the background begins.
    if (std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2])}) > 5.9) continue;
    ++inner;
    EXPECT_NEAR(normal.dot(point), 0.4, 1e-6) << point;
  }
  // Of its area of some 140 voxels each has a crossing and a cell.
  EXPECT_GT(inner, 200);
}

TEST(Isosurface, OfADoubleGridIsThatOfItsValues) {
  const auto grid = openvdb::DoubleGrid::create(1);
  grid->tree().setValue(openvdb::Coord(0), -3.0);
  const VoxelFrame frame(*grid);
  base::Job job(1, {});
  int crossings = 0;
  for (const Vec3& point : isosurfaceOf(*grid, frame, kBelowZero)->samples(job)) {
    // Three quarters of the way from the one sample inside to each of its six neighbours.
    const double sum = std::abs(point[0]) + std::abs(point[1]) + std::abs(point[2]);
    crossings += std::abs(sum - 0.75) < 1e-12 && std::abs(point.length() - 0.75) < 1e-12 ? 1 : 0;
  }
  EXPECT_EQ(crossings, 6);
}

TEST(Isosurface, OfALevelSetEndsWithItsBand) {
  auto grid = plane(Vec3(0, 0, 1), 0.5);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  const VoxelFrame frame(*grid);
  base::Job job(1, {});
  const auto all = isosurfaceOf(*grid, frame, kBelowZero)->samples(job).size();
  for (auto value = grid->beginValueOn(); value; ++value) {
    if (value.getCoord().x() > 0) value.setValueOff();
  }
  const auto same = isosurfaceOf(*grid, frame, kBelowZero)->samples(job);
  const bool beyond =
      std::any_of(same.begin(), same.end(), [](const Vec3& point) { return point[0] > 0; });
  EXPECT_TRUE(beyond) << "samples that are not active are distances, too, until one jumps";
  for (auto value = grid->beginValueOff(); value; ++value) {
    value.setValue(std::copysign(grid->background(), *value));
  }
  const auto some = isosurfaceOf(*grid, frame, kBelowZero)->samples(job);
  EXPECT_LT(some.size(), all);
  ASSERT_FALSE(some.empty());
  for (const Vec3& point : some) EXPECT_LE(point[0], 0);
}

TEST(TrilinearField, ProjectsToTheNearestPointOfAPlane) {
  const Vec3 normal = Vec3(2, 1, 2) / 3;
  const auto grid = plane(normal, -0.3);
  const VoxelFrame frame(*grid);
  const auto surface = isosurfaceOf(*grid, frame, kBelowZero);
  const auto field = surface->field();
  for (const Vec3& start : {Vec3(0.0), Vec3(1.3, -0.2, 0.4), Vec3(-1, -1, 1)}) {
    const auto found = field->project(start);
    ASSERT_TRUE(found) << start;
    const Vec3 foot = start - normal * (normal.dot(start) + 0.3);
    EXPECT_LT((*found - foot).length(), 1e-5) << start;
    EXPECT_LT((field->direction(start) - normal).length(), 1e-5);
  }
}

TEST(TrilinearField, ProjectsToNothingFarFromTheSurface) {
  const auto grid = plane(Vec3(0, 0, 1), 5.5);
  const VoxelFrame frame(*grid);
  const auto surface = isosurfaceOf(*grid, frame, kBelowZero);
  const auto field = surface->field();
  EXPECT_FALSE(field->project(Vec3(0, 0, 0.5))) << "five voxels are more than a few";
  EXPECT_TRUE(field->project(Vec3(0, 0, 3.5)));
  EXPECT_FALSE(field->project(Vec3(1e12, 0, 0)));
  EXPECT_EQ(field->direction(Vec3(100, 100, 100)), Vec3(0.0)) << "the background is flat";
}

}  // namespace
}  // namespace tufa::grid
