#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/box.h"
#include "base/vec3.h"

namespace tufa::base {

/// A ray made ready for boxes. It passes each box that the exact ray passes, and some that it just
/// misses.
struct BoxRay {
  Vec3 origin;
  Vec3 inverse;  ///< of the direction, by component; infinite where that is 0
  double from = 0;

  BoxRay(const Vec3& start, const Vec3& direction, double least)
      : origin(start), inverse(1 / direction[0], 1 / direction[1], 1 / direction[2]), from(least) {}

  /// Where it is in a box, between `from` and `to`; the first is above the second if nowhere.
  [[nodiscard]] std::pair<double, double> span(const Box& box, double to) const {
    double near = from;
    double far = to;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (std::isinf(inverse[axis])) {
        // Along the sides, in one of them perhaps.
        if (origin[axis] >= box.lower[axis] && origin[axis] <= box.upper[axis]) continue;
        return {1, 0};
      }
      const double a = (box.lower[axis] - origin[axis]) * inverse[axis];
      const double b = (box.upper[axis] - origin[axis]) * inverse[axis];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    // More than the differences and products are rounded by (Ize 2013).
    constexpr double kRoom = 4 * std::numeric_limits<double>::epsilon();
    return {near, std::min(to, far + kRoom * std::abs(far))};
  }

  /// Where it enters a box; infinite if it does not before `to`.
  [[nodiscard]] double entry(const Box& box, double to) const {
    const auto [near, far] = span(box, to);
    return near <= far ? near : std::numeric_limits<double>::infinity();
  }
};

}  // namespace tufa::base
