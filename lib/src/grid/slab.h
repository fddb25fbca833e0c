#pragma once

#include <tufa/coord.h>

#include <cstdint>

namespace tufa::grid {

/// What lies between two planes across an axis. Both ends belong to it.
struct Slab {
  int axis = 0;
  std::int32_t first = 0, last = 0;

  [[nodiscard]] bool contains(const Coord& at) const {
    return first <= at[axis] && at[axis] <= last;
  }
};

}  // namespace tufa::grid
