#include "octree/cut_rule.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "support/expect_error.h"

namespace tufa::octree {
namespace {

const grid::Transform kHalves(*openvdb::math::Transform::createLinearTransform(0.5));

CutRule ruleOf(const std::function<void(ContourOptions&)>& set) {
  ContourOptions options;
  set(options);
  return readRule(options, kHalves);
}

void expectRefused(const char* part, const std::function<void(ContourOptions&)>& set) {
  test::expectError(ErrorCode::InvalidArgument, part, [&] { (void)ruleOf(set); });
}

TEST(CutRule, OfTheDefaultsBoundsTheToleranceAlone) {
  const CutRule rule = ruleOf([](ContourOptions&) {});
  EXPECT_EQ(rule.tolerance, ContourOptions().tolerance);
  EXPECT_FALSE(rule.boundsAngle());
  EXPECT_EQ(rule.minLevel, 0);
  EXPECT_EQ(1 << rule.maxLevel, ContourOptions().maxCell);
  EXPECT_EQ(rule.toleranceAt(Vec3(1, 2, 3)), rule.tolerance);
}

TEST(CutRule, HasLevelsForSizesAndRadiansForDegrees) {
  const CutRule rule = ruleOf([](ContourOptions& o) {
    o.minCell = 4;
    o.maxCell = 32;
    o.maxAngle = 90;
  });
  EXPECT_EQ(rule.minLevel, 2);
  EXPECT_EQ(rule.maxLevel, 5);
  EXPECT_TRUE(rule.boundsAngle());
  EXPECT_DOUBLE_EQ(rule.maxAngle, std::numbers::pi / 2);
}

TEST(CutRule, ScalesItsToleranceInIndexSpace) {
  const auto scales = openvdb::FloatGrid::create(1);
  scales->tree().setValue(openvdb::Coord(3, 0, 0), 0.5F);  // at 3 in the world, 6 in the grid
  const CutRule rule = ruleOf([&](ContourOptions& o) {
    o.tolerance = 0.4;
    o.toleranceGrid = scales;
  });
  EXPECT_DOUBLE_EQ(rule.toleranceAt(Vec3(6, 0, 0)), 0.2);
  EXPECT_DOUBLE_EQ(rule.toleranceAt(Vec3(3, 0, 0)), 0.4);
}

TEST(CutRule, RefusesOptionsOutOfTheirRangeByNameAndValue) {
  expectRefused("tolerance must be from 0 to 1e", [](ContourOptions& o) { o.tolerance = 2e6; });
  expectRefused("tolerance", [](ContourOptions& o) { o.tolerance = -0.125; });
  expectRefused("-0.125", [](ContourOptions& o) { o.tolerance = -0.125; });
  expectRefused("tolerance", [](ContourOptions& o) { o.tolerance = std::nan(""); });
  expectRefused("angle", [](ContourOptions& o) { o.maxAngle = 180.5; });
  expectRefused("angle", [](ContourOptions& o) { o.maxAngle = -1; });
  expectRefused("least angle must be from 0 to 30, not 30.5",
                [](ContourOptions& o) { o.minAngle = 30.5; });
  expectRefused("least angle", [](ContourOptions& o) { o.minAngle = -1; });
  expectRefused("least angle", [](ContourOptions& o) { o.minAngle = std::nan(""); });
  for (const auto& excluded :
       {+[](ContourOptions& o) { o.simplify = false; }, +[](ContourOptions& o) { o.maxAngle = 90; },
        +[](ContourOptions& o) { o.maxCell = 8; }}) {
    expectRefused("collapsing edges", [&](ContourOptions& o) {
      excluded(o);
      o.minAngle = 20;
    });
  }
  expectRefused("smallest cell size", [](ContourOptions& o) { o.minCell = 0; });
  expectRefused("not 6", [](ContourOptions& o) { o.minCell = 6; });
  expectRefused("largest cell size", [](ContourOptions& o) { o.maxCell = -8; });
  expectRefused("must not be below the smallest", [](ContourOptions& o) {
    o.minCell = 8;
    o.maxCell = 4;
  });
}

TEST(CutRule, TakesTheEndsOfEachRange) {
  EXPECT_EQ(ruleOf([](ContourOptions& o) { o.tolerance = 0; }).tolerance, 0);
  EXPECT_EQ(ruleOf([](ContourOptions& o) { o.tolerance = 1e6; }).tolerance, 1e6);
  EXPECT_EQ(ruleOf([](ContourOptions& o) { o.maxAngle = 0; }).maxAngle, 0);
  EXPECT_EQ(ruleOf([](ContourOptions& o) { o.minAngle = 30; }).minAngle, 30);
  EXPECT_EQ(ruleOf([](ContourOptions& o) { o.maxCell = 1; }).maxLevel, 0);
}

TEST(MaySimplify, UnlessCellsAreBounded) {
  const auto may = [](const std::function<void(ContourOptions&)>& set) {
    ContourOptions options;
    set(options);
    return maySimplify(options);
  };
  EXPECT_TRUE(may([](ContourOptions&) {}));
  EXPECT_TRUE(may([](ContourOptions& o) { o.tolerance = 3; }));
  EXPECT_FALSE(may([](ContourOptions& o) { o.simplify = false; }));
  EXPECT_FALSE(may([](ContourOptions& o) { o.maxAngle = 45; }));
  EXPECT_FALSE(may([](ContourOptions& o) { o.maxCell = 64; }));
  EXPECT_FALSE(may([](ContourOptions& o) { o.minCell = 2; }));
}

}  // namespace
}  // namespace tufa::octree
