#pragma once

#include <array>

#include "base/vec3.h"

namespace tufa::implicit {

/// A point or a vector of numbers, of intervals, or of either with slopes.
template <class T>
using Triple = std::array<T, 3>;

template <class T>
[[nodiscard]] T dot(const Vec3& a, const Triple<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace tufa::implicit
