#pragma once

#include <algorithm>
#include <cmath>

#include "uniform/qef.h"

namespace tufa::extraction {

/// Where tangent planes of two sheets or more meet, in voxels from the middle of a cell: the best
/// point in the cell, and the best up to a voxel outside.
struct CreasePoint {
  /// Vertices in the cell keep this distance from its faces, as those of dual contouring do.
  static constexpr float kHalfCell = 0.499F;
  static constexpr float kHalfBeyond = 1.499F;
  /// Voxels: sheets meet in the cell if its best point is as near to them, as root mean square.
  /// Less makes more vertices leave their cells and fans intersect, more leaves creases cut off.
  static constexpr float kNear = 0.05F;

  uniform::Vector inside{};
  uniform::Vector beyond{};
  bool isInside = true;  ///< they meet in the cell

  /// Whether it is worth a closer look: most planes from beside a cell meet far from it.
  [[nodiscard]] static bool mayBeInside(const uniform::Qef& planes) {
    constexpr float kHalfNear = 0.75F;
    return uniform::solveInside(planes, kHalfNear).has_value();
  }

  /// The mass point of the planes must lie in the cell.
  explicit CreasePoint(const uniform::Qef& planes)
      : inside(uniform::solve(planes, kHalfCell)), beyond(inside) {
    // A least error that is not at the cell's faces is the least of all.
    constexpr float kAtFaces = 0.9999F * kHalfCell;
    if (std::all_of(inside.begin(), inside.end(), [](float x) { return std::abs(x) < kAtFaces; })) {
      return;
    }
    beyond = uniform::solve(planes, kHalfBeyond);
    const uniform::Vector step = {beyond[0] - inside[0], beyond[1] - inside[1],
                                  beyond[2] - inside[2]};
    isInside = planes.meanSquare(step) <= kNear * kNear;
  }
};

}  // namespace tufa::extraction
