// The union of level sets.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <tufa/unite.h>

#include <tufa/contour.h>
#include <cmath>
#include <limits>

#include "support/expect_error.h"

namespace tufa {
namespace {

using openvdb::DoubleGrid;
using openvdb::FloatGrid;
using openvdb::GridBase;
using test::expectError;

template <class GridT = FloatGrid>
typename GridT::Ptr makeBall(float radius, float x, float voxel = 0.1F, float halfWidth = 3) {
  auto grid = openvdb::tools::createLevelSetSphere<GridT>(radius, {x, 0, 0}, voxel, halfWidth);
  grid->setName("ball");
  return grid;
}

/// The distance of the places that a mesh of two balls of radius 1, around 0 and x, strays from
/// them.
double strayOf(const GridBase& grid, double x) {
  ContourOptions options;
  options.uniform = true;
  double stray = 0;
  const Mesh mesh = contour(grid, options);
  EXPECT_GT(mesh.triangleCount(), 0u);
  for (const Position& p : mesh.positions) {
    const double distance = std::min(std::hypot(p.x, p.y, p.z), std::hypot(p.x - x, p.y, p.z)) - 1;
    stray = std::max(stray, std::abs(distance));
  }
  return stray;
}

TEST(Unite, IsInsideWhereAnyIs) {
  const auto a = makeBall(1, 0);
  const auto b = makeBall(1, 1.2F);
  const auto grid = uniteLevelSets({a, b});
  ASSERT_TRUE(grid->isType<FloatGrid>());
  const auto& sum = static_cast<const FloatGrid&>(*grid);
  EXPECT_EQ(sum.transform(), a->transform());
  for (auto value = a->cbeginValueOn(); value; ++value) {
    const float expected = std::min(*value, b->tree().getValue(value.getCoord()));
    ASSERT_EQ(sum.tree().getValue(value.getCoord()), expected);
  }
  EXPECT_LT(strayOf(*grid, 1.2), 0.02);
  // What was given stays as it was.
  EXPECT_EQ(a->activeVoxelCount(), makeBall(1, 0)->activeVoxelCount());
}

TEST(Unite, SamplesOnTheFinestLattice) {
  const auto coarse = makeBall(1, 0, 0.1F);
  const auto fine = makeBall(1, 1.5F, 0.05F, 4);
  fine->setName("fine");
  auto turned = fine->deepCopy();
  turned->transform().preRotate(0.3, openvdb::math::Z_AXIS);  // about the lattice's origin
  for (const auto& grids : {std::vector<std::shared_ptr<const GridBase>>{coarse, fine},
                            std::vector<std::shared_ptr<const GridBase>>{fine, coarse}}) {
    const auto grid = uniteLevelSets(grids);
    EXPECT_EQ(grid->transform(), fine->transform());
    EXPECT_EQ(grid->getName(), "fine");
    EXPECT_FLOAT_EQ(static_cast<const FloatGrid&>(*grid).background(), 0.2F);  // of the fine one
    EXPECT_LT(strayOf(*grid, 1.5), 0.02);
  }
  const auto grid = uniteLevelSets({turned, coarse});
  ContourOptions options;
  options.uniform = true;
  for (const Position& p : contour(*grid, options).positions) {
    const double other = std::hypot(p.x - 1.5 * std::cos(0.3), p.y - 1.5 * std::sin(0.3), p.z);
    ASSERT_NEAR(std::min(std::hypot(p.x, p.y, p.z), other), 1, 0.02);
  }
}

TEST(Unite, NarrowsBandsToTheNarrowest) {
  const auto wide = makeBall(1, 0, 0.1F, 6);
  const auto narrow = makeBall(1, 5, 0.1F, 3);
  for (const auto& grid : {uniteLevelSets({wide, narrow}), uniteLevelSets({narrow, wide})}) {
    const auto& sum = static_cast<const FloatGrid&>(*grid);
    EXPECT_FLOAT_EQ(sum.background(), 0.3F);
    EXPECT_EQ(sum.activeVoxelCount(),
              makeBall(1, 0)->activeVoxelCount() + narrow->activeVoxelCount());
    for (auto value = sum.cbeginValueAll(); value; ++value) {
      ASSERT_LE(std::abs(*value), sum.background());
    }
    EXPECT_LT(strayOf(*grid, 5), 0.02);
  }
}

TEST(Unite, KeepsDoublesAndLeavesEmptyGridsOut) {
  const auto empty = FloatGrid::create(0.3F);
  empty->setGridClass(openvdb::GRID_LEVEL_SET);
  const auto grid = uniteLevelSets({empty, makeBall(1, 0), makeBall<DoubleGrid>(1, 3)});
  EXPECT_TRUE(grid->isType<DoubleGrid>());
  EXPECT_LT(strayOf(*grid, 3), 0.02);
  double done = 0;
  UniteOptions options;
  options.progress = [&](std::string_view, double fraction) { return (done = fraction) <= 1; };
  EXPECT_TRUE(uniteLevelSets({empty}, options)->empty());
  EXPECT_EQ(done, 1);
}

TEST(Unite, RefusesWhatHasNoUnion) {
  const auto ball = makeBall(1, 0);
  expectError(ErrorCode::InvalidArgument, "one grid at least", [] { (void)uniteLevelSets({}); });
  const auto fog = ball->deepCopy();
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  expectError(ErrorCode::UnsupportedGrid, "is none", [&] { (void)uniteLevelSets({ball, fog}); });

  auto flat = ball->deepCopy();
  flat->transform().preScale({1, 1, 2});
  expectError(ErrorCode::UnsupportedGrid, "voxels that are no cubes", [&] {
    (void)uniteLevelSets({ball, flat});
  });
  EXPECT_FALSE(uniteLevelSets({flat, flat})->empty());  // on one lattice nothing is sampled

  auto far = ball->deepCopy();
  far->transform().postTranslate({1e9, 0, 0});
  expectError(ErrorCode::UnsupportedGrid, "too far away", [&] {
    (void)uniteLevelSets({ball, far});
  });

  auto broken = ball->deepCopy();
  broken->tree().setValueOn({10, 0, 0}, std::numeric_limits<float>::quiet_NaN());
  expectError(ErrorCode::NonFiniteValues, "1 NaN or infinite", [&] {
    (void)uniteLevelSets({ball, broken});
  });

  broken = ball->deepCopy();
  broken->tree().addTile(2, {100000, 0, 0}, std::numeric_limits<float>::infinity(), false);
  expectError(ErrorCode::NonFiniteValues, "1 NaN or infinite", [&] {
    (void)uniteLevelSets({ball, broken});
  });
  const auto endless = openvdb::FloatGrid::create(std::numeric_limits<float>::infinity());
  endless->setGridClass(openvdb::GRID_LEVEL_SET);
  expectError(ErrorCode::NonFiniteValues, "background", [&] {
    (void)uniteLevelSets({ball, endless});
  });

  UniteOptions options;
  options.mostVoxels = 1000;
  expectError(ErrorCode::LimitExceeded, "the union would sample", [&] {
    (void)uniteLevelSets({ball, makeBall(1, 3, 0.05F)}, options);
  });
  options = {};
  options.progress = [](std::string_view, double) { return false; };
  expectError(ErrorCode::Cancelled, "cancelled", [&] {
    (void)uniteLevelSets({ball, ball}, options);
  });
}

TEST(Unite, IsTheSameForAnyThreads) {
  UniteOptions one;
  one.threads = 1;
  const auto a = makeBall(1, 0);
  const auto b = makeBall(1, 1.5F, 0.05F);
  const auto first = uniteLevelSets({a, b}, one);
  const auto second = uniteLevelSets({a, b});
  const auto& sum = static_cast<const FloatGrid&>(*second);
  EXPECT_EQ(first->activeVoxelCount(), second->activeVoxelCount());
  for (auto v = static_cast<const FloatGrid&>(*first).cbeginValueOn(); v; ++v) {
    ASSERT_EQ(sum.tree().getValue(v.getCoord()), *v);
  }
}

}  // namespace
}  // namespace tufa
