#include "uniform/cube_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "support/block_field.h"
#include "support/print.h"

namespace tufa::uniform {
namespace {

using test::distanceAroundBlock;

/// Calls body(cube's middle, plane or null) for the cubes around the block.
template <class Body>
void forPlanes(const test::BlockField& field, const Body& body) {
  const auto planes = std::make_unique<CubePlanes>(field.samples(), field.scale());
  for (int x = -1; x <= 8; ++x) {
    for (int y = -1; y <= 8; ++y) {
      for (int z = -1; z <= 8; ++z) body(Vec3(x + 0.5, y + 0.5, z + 0.5), planes->at(x, y, z));
    }
  }
}

TEST(CubePlanes, OfAPlaneAreThatPlaneWhereverTheBandReaches) {
  const Vec3 normal = Vec3(1, -2, 3).unitOrX();
  const test::PlaneDistance plane{normal, normal.dot(Vec3(4, 3.6, 4.1))};
  const auto field = distanceAroundBlock(plane, 3);
  int found = 0;
  forPlanes(field, [&](const Vec3& middle, const CubePlane* patch) {
    double farthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 offset((corner >> 2) - 0.5, ((corner >> 1) & 1) - 0.5, (corner & 1) - 0.5);
      farthest = std::max(farthest, std::abs(plane(middle + offset)));
    }
    if (std::abs(farthest - 3) < 0.01) return;
    ASSERT_EQ(patch != nullptr, farthest < 3) << middle;
    if (patch == nullptr) return;
    ++found;
    EXPECT_LT((toVec3(patch->normal) - normal).length(), 1e-5);
    EXPECT_LT((toVec3(patch->foot) - (middle - normal * plane(middle))).length(), 1e-4);
    EXPECT_LT(patch->residual, 1e-5);
  });
  EXPECT_GT(found, 200);
}

TEST(CubePlanes, NearACreaseAreOfOneSideOrNone) {
  const test::TurnedBoxDistance box = test::boxWithCornerInBlock();
  const auto field = distanceAroundBlock(box);
  int planes = 0, none = 0;
  forPlanes(field, [&](const Vec3& middle, const CubePlane* patch) {
    if (box(middle) > -0.9) return;  // beyond the edges the distance is round, not kinked
    if (box(middle) < -2.5) return;
    if (patch == nullptr) {
      ++none;
      return;
    }
    ++planes;
    EXPECT_GT(box.cosineToAxis(toVec3(patch->normal)), 0.985) << middle;
    EXPECT_LT(std::abs(box(toVec3(patch->foot))), 0.1) << middle;
  });
  EXPECT_GE(planes, 15);
  EXPECT_GT(none, 5);
}

}  // namespace
}  // namespace tufa::uniform
