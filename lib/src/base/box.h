#pragma once

#include <algorithm>
#include <limits>

#include "base/vec3.h"

namespace tufa::base {

/// An axis-aligned box with its faces.
struct Box {
  Vec3 lower;
  Vec3 upper;

  /// A box that holds nothing and grows from the first point.
  static Box empty() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {Vec3(kInfinity), Vec3(-kInfinity)};
  }
  [[nodiscard]] bool isEmpty() const {
    return lower[0] > upper[0] || lower[1] > upper[1] || lower[2] > upper[2];
  }
  [[nodiscard]] Vec3 centre() const { return (lower + upper) * 0.5; }
  [[nodiscard]] Vec3 size() const { return upper - lower; }
  void add(const Vec3& point) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], point[axis]);
      upper[axis] = std::max(upper[axis], point[axis]);
    }
  }
  void add(const Box& other) {
    add(other.lower);
    add(other.upper);
  }
  [[nodiscard]] bool meets(const Box& other) const {
    return lower[0] <= other.upper[0] && other.lower[0] <= upper[0] && lower[1] <= other.upper[1] &&
           other.lower[1] <= upper[1] && lower[2] <= other.upper[2] && other.lower[2] <= upper[2];
  }
  [[nodiscard]] double distanceSquared(const Vec3& point) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = std::max({lower[axis] - point[axis], point[axis] - upper[axis], 0.0});
      sum += d * d;
    }
    return sum;
  }
};

}  // namespace tufa::base
