#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <tufa/shapes.h>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "support/expect_error.h"

namespace tufa {
namespace {

using test::expectError;

openvdb::FloatGrid::Ptr make(Shape shape, double voxelSize, int threads = 0) {
  ShapeOptions options;
  options.voxelSize = voxelSize;
  options.threads = threads;
  return makeShape(shape, options);
}

Position at(const openvdb::Coord& ijk, double voxelSize) {
  return {ijk.x() * voxelSize, ijk.y() * voxelSize, ijk.z() * voxelSize};
}

class LevelSetShapes : public ::testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, LevelSetShapes,
                         ::testing::Values(Shape::Sphere, Shape::Torus, Shape::Box, Shape::Bracket,
                                           Shape::Gyroid, Shape::Terrain),
                         [](const auto& test) {
                           return std::string(shapeNames()[static_cast<std::size_t>(test.param)]);
                         });

/// The culling is an optimization: the grid must hold the clamped field at every lattice point.
TEST_P(LevelSetShapes, HoldsTheClampedFieldEverywhere) {
  const double voxelSize = 0.05;
  const auto grid = make(GetParam(), voxelSize);
  const double band = 3 * voxelSize;
  const int reach = static_cast<int>(1.6 / voxelSize);
  for (const openvdb::Coord& ijk :
       openvdb::CoordBBox(openvdb::Coord(-reach), openvdb::Coord(reach))) {
    const double truth = shapeDistance(GetParam(), at(ijk, voxelSize));
    ASSERT_NEAR(grid->tree().getValue(ijk), std::clamp(truth, -band, band), 1e-6) << ijk;
    ASSERT_EQ(grid->tree().isValueOn(ijk),
              std::abs(static_cast<float>(truth)) < grid->background());
  }
}

TEST_P(LevelSetShapes, IsANamedLevelSet) {
  const auto grid = make(GetParam(), 0.1);
  EXPECT_EQ(grid->getName(), shapeNames()[static_cast<std::size_t>(GetParam())]);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid->transform().voxelSize(), openvdb::Vec3d(0.1));
}

class EveryShape : public ::testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape,
                         ::testing::Values(Shape::Sphere, Shape::Torus, Shape::Box, Shape::Bracket,
                                           Shape::Gyroid, Shape::Terrain, Shape::Noise, Shape::Fog),
                         [](const auto& test) {
                           return std::string(shapeNames()[static_cast<std::size_t>(test.param)]);
                         });

TEST_P(EveryShape, IsTheSameForAnyNumberOfThreads) {
  const auto one = make(GetParam(), 0.04, 1);
  const auto two = make(GetParam(), 0.04, 2);
  EXPECT_TRUE(one->tree().hasSameTopology(two->tree()));
  for (auto value = one->cbeginValueOn(); value; ++value) {
    ASSERT_EQ(two->tree().getValue(value.getCoord()), *value);
  }
}

TEST_P(EveryShape, CanBeCancelled) {
  ShapeOptions options;
  options.progress = [](std::string_view, double) { return false; };
  expectError(ErrorCode::Cancelled, "cancelled", [&] { (void)makeShape(GetParam(), options); });
}

TEST_P(EveryShape, RefusesUnusableSizes) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double voxelSize : {0.0, -1.0, infinity, std::nan(""), 1e-12, 1e-320}) {
    expectError(ErrorCode::InvalidArgument, "voxel size",
                [&] { (void)make(GetParam(), voxelSize); });
  }
  ShapeOptions options;
  options.halfWidth = 0.5;
  expectError(ErrorCode::InvalidArgument, "half width",
              [&] { (void)makeShape(GetParam(), options); });
}

double insideVolume(Shape shape, double voxelSize) {
  const auto grid = make(shape, voxelSize);
  double voxels = 0;
  for (auto value = grid->cbeginValueAll(); value; ++value) {
    if (*value < 0) voxels += static_cast<double>(value.getVoxelCount());
  }
  return voxels * voxelSize * voxelSize * voxelSize;
}

TEST(Shapes, HaveTheirVolume) {
  const double pi = std::numbers::pi;
  EXPECT_NEAR(insideVolume(Shape::Sphere, 0.02), 4 * pi / 3, 0.01);
  EXPECT_NEAR(insideVolume(Shape::Torus, 0.02), 2 * pi * pi * 0.35 * 0.35, 0.01);
  EXPECT_NEAR(insideVolume(Shape::Box, 0.02), 8 * 0.9 * 0.7 * 0.5, 0.01);
  const double plates = 1.8 * 1.0 * 0.25 + 0.25 * 1.0 * 1.15;
  const double rib = 0.5 * 0.8 * 0.8 * 0.2;
  const double holes =
      pi * (0.25 * (2 * 0.12 * 0.12 + 2 * 0.11 * 0.11 + 0.1 * 0.1) + 0.2 * 0.1 * 0.1);
  EXPECT_NEAR(insideVolume(Shape::Bracket, 0.02), plates + rib - holes, 0.01);
}

TEST(Shapes, CreasesLieOnTheSurfaceAndAreDense) {
  for (const Shape shape : {Shape::Box, Shape::Bracket}) {
    const auto points = shapeCreasePoints(shape, 0.01);
    ASSERT_GT(points.size(), 1000u);
    for (const Position& p : points) ASSERT_NEAR(shapeDistance(shape, p), 0, 1e-12);
  }
  EXPECT_TRUE(shapeCreasePoints(Shape::Sphere, 0.01).empty());
}

/// On a crease the surface bends: not far from it, some direction has no unit gradient.
TEST(Shapes, CreasesAreSharp) {
  const double step = 1e-4;
  for (const Shape shape : {Shape::Box, Shape::Bracket}) {
    for (const Position& p : shapeCreasePoints(shape, 0.05)) {
      const double gx = shapeDistance(shape, {p.x + step, p.y, p.z}) -
                        shapeDistance(shape, {p.x - step, p.y, p.z});
      const double gy = shapeDistance(shape, {p.x, p.y + step, p.z}) -
                        shapeDistance(shape, {p.x, p.y - step, p.z});
      const double gz = shapeDistance(shape, {p.x, p.y, p.z + step}) -
                        shapeDistance(shape, {p.x, p.y, p.z - step});
      ASSERT_LT(std::hypot(gx, gy, gz) / (2 * step), 0.95);
    }
  }
}

/// A distance never changes faster than its point moves, and by as much along the gradient.
TEST(Shapes, ExactDistancesAreDistances) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.4, 1.4);
  for (const Shape shape : {Shape::Torus, Shape::Box, Shape::Bracket}) {
    for (int n = 0; n < 20000; ++n) {
      const Position p(place(random), place(random), place(random));
      const Position q(place(random), place(random), place(random));
      const double apart = std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
      ASSERT_LE(std::abs(shapeDistance(shape, p) - shapeDistance(shape, q)), apart + 1e-12);
    }
  }
}

TEST(Shapes, NoiseAndFogHaveNoDistance) {
  for (const Shape shape : {Shape::Noise, Shape::Fog}) {
    expectError(ErrorCode::InvalidArgument, "noise and fog", [&] {
      (void)shapeDistance(shape, {0, 0, 0});
    });
  }
}

TEST(Shapes, NoiseFillsItsCubeInsideABorder) {
  const auto grid = make(Shape::Noise, 2.0 / 16);
  EXPECT_EQ(grid->activeVoxelCount(), 18u * 18u * 18u);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_UNKNOWN);
  std::size_t inside = 0;
  const openvdb::CoordBBox cube(openvdb::Coord(-8), openvdb::Coord(7));
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    if (!cube.isInside(value.getCoord())) {
      ASSERT_EQ(*value, 1.0f);
    } else {
      ASSERT_LE(std::abs(*value), 1.0f);
      inside += *value < 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(inside) / 4096, 0.5, 0.05);
}

TEST(Shapes, SeedsChangeRandomShapes) {
  for (const Shape shape : {Shape::Noise, Shape::Fog, Shape::Terrain}) {
    ShapeOptions options;
    options.voxelSize = 0.1;
    const auto first = makeShape(shape, options);
    options.seed = 2;
    const auto second = makeShape(shape, options);
    double difference = 0;
    for (auto value = first->cbeginValueOn(); value; ++value) {
      difference += std::abs(*value - second->tree().getValue(value.getCoord()));
    }
    EXPECT_GT(difference, 1);
  }
}

TEST(Shapes, FogIsADensity) {
  const auto grid = make(Shape::Fog, 0.05);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(grid->background(), 0.0f);
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    ASSERT_GT(*value, 0.0f);
    ASSERT_LT(*value, 1.0f);
  }
}

TEST(Shapes, NamesLeadBack) {
  for (const auto name : shapeNames()) {
    ASSERT_TRUE(shapeByName(name));
    EXPECT_EQ(shapeNames()[static_cast<std::size_t>(*shapeByName(name))], name);
  }
  EXPECT_FALSE(shapeByName("cube"));
}

}  // namespace
}  // namespace tufa
