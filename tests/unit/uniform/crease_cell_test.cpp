#include "uniform/crease_cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "support/block_field.h"
#include "support/print.h"

namespace tufa::uniform {
namespace {

using test::BlockField;
using test::distanceAroundBlock;

/// Calls body(cell's middle, placement) for the surface cells of the block.
template <class Body>
void forCells(const BlockField& field, const Body& body) {
  const auto creaseCell = std::make_unique<CreaseCell>(field.samples(), field.scale());
  creaseCell->reset();
  for (int cell = 0; cell < 512; ++cell) {
    const int x = cell >> 6, y = (cell >> 3) & 7, z = cell & 7;
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int at =
          grid::BlockSamples::index(x + (corner >> 2), y + ((corner >> 1) & 1), z + (corner & 1));
      inside += field.samples()[at] < 0 ? 1 : 0;
    }
    if (inside == 0 || inside == 8) continue;
    body(Vec3(x + 0.5, y + 0.5, z + 0.5), creaseCell->place(x, y, z, {}));
  }
}

TEST(CreaseCell, OnAPlaneIsOnOneSide) {
  const Vec3 normal = Vec3(2, 1, -2) / 3;
  const test::PlaneDistance plane{normal, normal.dot(Vec3(3.6))};
  int cells = 0;
  forCells(distanceAroundBlock(plane), [&](const Vec3& middle, const CreasePlacement& placement) {
    ++cells;
    ASSERT_EQ(placement.planes, 1);
    EXPECT_NEAR(plane(middle + toVec3(placement.point)), 0, 1e-4);
    EXPECT_LT((toVec3(placement.normal) - normal).length(), 1e-4);
  });
  EXPECT_GT(cells, 64);
}

TEST(CreaseCell, FindsTheCreasesAndTheCornerOfABox) {
  const test::TurnedBoxDistance box = test::boxWithCornerInBlock();
  int corners = 0, creases = 0, sheets = 0;
  forCells(distanceAroundBlock(box), [&](const Vec3& middle, const CreasePlacement& placement) {
    if (placement.planes == 0) return;
    const Vec3 point = middle + toVec3(placement.point);
    EXPECT_LT(std::abs(box(point)), 0.03) << middle;
    if (placement.planes == 1) {
      ++sheets;
      return;
    }
    // On a crease two of the box's coordinates are at their end, at the corner all three.
    const Vec3 off = box.fromCorner(point);
    int ends = 0;
    for (int axis = 0; axis < 3; ++axis) ends += std::abs(off[axis]) < 0.15 ? 1 : 0;
    EXPECT_GE(ends, placement.planes) << middle << " " << off;
    (placement.planes == 3 ? corners : creases)++;
    for (int i = 0; i < placement.planes; ++i) {
      EXPECT_GT(box.cosineToAxis(toVec3(placement.sheets[i])), 0.98) << middle;
    }
  });
  EXPECT_LE(corners, 1);
  EXPECT_GT(creases, 8);
  EXPECT_GT(sheets, 20);
}

TEST(CreaseCell, FindsNoCreaseOnASphere) {
  const Vec3 center = Vec3(4) - Vec3(0.3, 0.7, 1).unitOrX() * 12;
  const auto distance = [&](const Vec3& p) { return (p - center).length() - 12; };
  int cells = 0;
  forCells(distanceAroundBlock(distance),
           [&](const Vec3& middle, const CreasePlacement& placement) {
             ++cells;
             EXPECT_LE(placement.planes, 1) << middle;
           });
  EXPECT_GT(cells, 64);
}

}  // namespace
}  // namespace tufa::uniform
