#include "grid/tolerance_scale.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/expect_error.h"
#include "support/fields.h"

namespace tufa::grid {
namespace {

using openvdb::FloatGrid;

const Transform kIdentity(*openvdb::math::Transform::createLinearTransform(1.0));

TEST(ToleranceScale, IsTheNearestValue) {
  const auto scales = FloatGrid::create(7);
  scales->tree().setValue(openvdb::Coord(1, 2, 3), 0.5F);
  const auto scale = toleranceScale(scales, kIdentity);
  EXPECT_EQ(scale(Vec3(1, 2, 3)), 0.5);
  EXPECT_EQ(scale(Vec3(1.4, 1.6, 3.4)), 0.5);
  EXPECT_EQ(scale(Vec3(1.6, 2, 3)), 7);
  EXPECT_EQ(scale(Vec3(-1e6, 0, 0)), 7) << "the background";
  EXPECT_EQ(scale(Vec3(1e30, 0, 0)), 7) << "beyond all coordinates";
  scales->tree().setValue(openvdb::Coord(2100000000, -2100000000, 5), 3);
  EXPECT_EQ(scale(Vec3(2.1e9, -2.1e9, 5)), 3);
}

TEST(ToleranceScale, IsZeroWhereTheValueSaysNothing) {
  const auto scales = FloatGrid::create(1);
  const float values[] = {-2, std::numeric_limits<float>::quiet_NaN(),
                          -std::numeric_limits<float>::infinity()};
  for (int i = 0; i < 3; ++i) scales->tree().setValue(openvdb::Coord(i, 0, 0), values[i]);
  const auto scale = toleranceScale(scales, kIdentity);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(scale(Vec3(i, 0, 0)), 0) << values[i];
  EXPECT_EQ(scale(Vec3(3, 0, 0)), 1);
  scales->tree().setValue(openvdb::Coord(3, 0, 0), std::numeric_limits<float>::infinity());
  EXPECT_EQ(scale(Vec3(3, 0, 0)), double{std::numeric_limits<float>::max()});
}

TEST(ToleranceScale, LooksAtTheSamePlaceOfTheWorld) {
  // Voxels of 2 from 10 on, asked by a grid with voxels of 0.5 from -3 on.
  const auto scales = FloatGrid::create(1);
  scales->setTransform(openvdb::math::Transform::createLinearTransform(2));
  scales->transform().postTranslate(openvdb::Vec3d(10, 0, 0));
  scales->tree().setValue(openvdb::Coord(3, 0, 0), 0.25F);  // at 16
  const auto meshed = openvdb::math::Transform::createLinearTransform(0.5);
  meshed->postTranslate(openvdb::Vec3d(-3, 0, 0));
  const auto scale = toleranceScale(scales, Transform(*meshed));
  EXPECT_EQ(scale(Vec3(38, 0, 0)), 0.25);
  EXPECT_EQ(scale(Vec3(39.5, 0, 0)), 0.25);
  EXPECT_EQ(scale(Vec3(41, 0, 0)), 1);
}

TEST(ToleranceScale, RefusesOtherValuesThanFloats) {
  const auto refused = [](const openvdb::GridBase::Ptr& scales, const char* type) {
    scales->setName("detail");
    test::expectError(ErrorCode::UnsupportedGrid, type,
                      [&] { (void)toleranceScale(scales, kIdentity); });
    test::expectError(ErrorCode::UnsupportedGrid, "\"detail\"",
                      [&] { (void)toleranceScale(scales, kIdentity); });
  };
  refused(openvdb::DoubleGrid::create(1), "double");
  refused(openvdb::Int32Grid::create(1), "int32");
  refused(openvdb::BoolGrid::create(true), "bool");
}

}  // namespace
}  // namespace tufa::grid
