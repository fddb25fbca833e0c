#pragma once

#include <tufa/coord.h>

#include <limits>

#include "base/vec3.h"

namespace tufa::base {

/// A box of lattice points, cells or chunks; both corners belong to it.
struct IndexBox {
  Coord min{std::numeric_limits<std::int32_t>::max()};
  Coord max{std::numeric_limits<std::int32_t>::min()};

  [[nodiscard]] bool isEmpty() const {
    return min[0] > max[0] || min[1] > max[1] || min[2] > max[2];
  }
  [[nodiscard]] bool contains(const Coord& at) const {
    return min[0] <= at[0] && at[0] <= max[0] && min[1] <= at[1] && at[1] <= max[1] &&
           min[2] <= at[2] && at[2] <= max[2];
  }
  /// How many along each axis; 0 if empty.
  [[nodiscard]] Coord size() const { return isEmpty() ? Coord() : max.offsetBy(1) - min; }
  [[nodiscard]] Vec3 centre() const { return (Vec3(min) + Vec3(max)) * 0.5; }
  void add(const Coord& at) {
    min = minCoord(min, at);
    max = maxCoord(max, at);
  }
  /// The box extended by so much on all sides.
  [[nodiscard]] IndexBox grownBy(std::int32_t by) const {
    return {min.offsetBy(-by), max.offsetBy(by)};
  }
};

}  // namespace tufa::base
