// Arrays for hosts, and <tufa/fwd.h>, which comes first so that it must agree with what follows.

#include <tufa/fwd.h>

#include <gtest/gtest.h>
#include <tufa/check.h>
#include <tufa/tufa.h>

#include <cmath>
#include <limits>

#include "support/expect_error.h"

namespace tufa {
namespace {

Mesh makeTent(double shift = 0) {
  Mesh mesh;
  mesh.positions = {
      {shift, 0, 0}, {shift + 1, 0, 0}, {shift + 1, 1, 0}, {shift, 1, 0}, {shift + 0.5, 0.5, 1}};
  mesh.normals.assign(5, Normal(0, 0, 1));
  mesh.quads = {{0, 3, 2, 1}};
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  return mesh;
}

TEST(FloatMesh, HasQuadsThenTriangles) {
  const tufa::FloatMesh mesh = toFloat(makeTent());
  EXPECT_EQ(mesh.faceCounts, (std::vector<int>{4, 3, 3, 3, 3}));
  EXPECT_EQ(mesh.faceIndices, (std::vector<int>{0, 3, 2, 1, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4}));
  EXPECT_EQ(mesh.positions.at(4), (std::array<float, 3>{0.5F, 0.5F, 1}));
  EXPECT_EQ(mesh.normals.size(), 5u);
  EXPECT_EQ(mesh.origin, Position(0, 0, 0));
}

TEST(FloatMesh, ClockwiseFacesKeepTheirFirstCorner) {
  FloatMeshOptions options;
  options.winding = Winding::Clockwise;
  const tufa::FloatMesh mesh = toFloat(makeTent(), options);
  EXPECT_EQ(mesh.faceIndices, (std::vector<int>{0, 1, 2, 3, 0, 4, 1, 1, 4, 2, 2, 4, 3, 3, 4, 0}));
}

TEST(FloatMesh, PositionsFarAwayAreCountedFromTheMiddle) {
  const double far = 1e9 + 0.25;
  const tufa::FloatMesh mesh = toFloat(makeTent(far));
  EXPECT_EQ(mesh.origin.x, far + 0.5);
  for (std::size_t v = 0; v < 5; ++v) {
    EXPECT_EQ(mesh.origin.x + mesh.positions[v][0], makeTent(far).positions[v].x);
  }
  FloatMeshOptions options;
  options.relative = false;
  EXPECT_EQ(toFloat(makeTent(far), options).origin, Position(0, 0, 0));
  EXPECT_EQ(toFloat(makeTent(far), options).positions[0][0], 1e9F);
}

TEST(FloatMesh, RefusesWhatNoFloatIsNear) {
  Mesh mesh;
  mesh.positions = {{1e300, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles.emplace_back(0, 1, 2);
  test::expectError(ErrorCode::LimitExceeded, "single precision", [&] { (void)toFloat(mesh); });
}

TEST(FloatMesh, OfNothingIsEmpty) {
  const tufa::FloatMesh mesh = toFloat({});
  EXPECT_TRUE(mesh.positions.empty());
  EXPECT_TRUE(mesh.faceIndices.empty());
}

}  // namespace
}  // namespace tufa
