#pragma once

#include <array>
#include <cmath>

#include "grid/field.h"

namespace tufa::grid {

/// Where the data of a level set end, and contour() leaves the surface open: at lattice edges on
/// which the surface lies between two samples, not both active, that are further apart than a
/// distance can change in one step. Elsewhere samples that are not active are distances, too.
class DataEnd {
 public:
  explicit DataEnd(const FieldScale& scale) : exists_(scale.narrowBand) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      longest_[axis] = kLongestStep * scale.axisLength[axis] / std::abs(scale.factor);
    }
  }

  /// Whether there may be such edges.
  [[nodiscard]] bool exists() const { return exists_; }

  /// Whether an edge along an axis is one, if the surface passes it between values `a` and `b`.
  [[nodiscard]] bool isAt(std::size_t axis, double a, double b, bool bothActive) const {
    return exists_ && !bothActive && std::abs(a - b) > longest_[axis];
  }

  /// Whether a cell has one. Corner n is at (n & 1, n >> 1 & 1, n >> 2) from the cell, and bit n of
  /// the masks tells whether it is inside and active.
  [[nodiscard]] bool isIn(const std::array<double, 8>& corners, unsigned inside,
                          unsigned active) const {
    if (!exists_ || active == 0xFF) return false;
    for (unsigned n = 0; n < 8; ++n) {
      for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned m = n | 1U << axis;
        if (m == n || ((inside >> n ^ inside >> m) & 1U) == 0) continue;
        if (isAt(axis, corners[n], corners[m], (active >> n & active >> m & 1U) != 0)) return true;
      }
    }
    return false;
  }

 private:
  bool exists_;
  std::array<double, 3> longest_{};  ///< steps of a distance along each axis
};

}  // namespace tufa::grid
