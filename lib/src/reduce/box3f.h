#pragma once

#include <limits>

#include "base/vec3f.h"

namespace tufa::reduce {

using base::Vec3f;

/// An axis-aligned box with its faces, in single precision. Holds nothing at first.
struct Box3f {
  Vec3f lower{kMost, kMost, kMost};
  Vec3f upper{-kMost, -kMost, -kMost};

  void add(const Vec3f& point) {
    lower = minVec3f(lower, point);
    upper = maxVec3f(upper, point);
  }
  void add(const Box3f& other) {
    lower = minVec3f(lower, other.lower);
    upper = maxVec3f(upper, other.upper);
  }
  void growBy(float by) {
    lower = lower - Vec3f(by, by, by);
    upper = upper + Vec3f(by, by, by);
  }
  [[nodiscard]] bool meets(const Box3f& other) const {
    return other.lower.x <= upper.x && other.upper.x >= lower.x && other.lower.y <= upper.y &&
           other.upper.y >= lower.y && other.lower.z <= upper.z && other.upper.z >= lower.z;
  }
  /// Whether a point lies inside and on none of the faces.
  [[nodiscard]] bool hasInside(const Vec3f& p) const {
    return p.x > lower.x && p.x < upper.x && p.y > lower.y && p.y < upper.y && p.z > lower.z &&
           p.z < upper.z;
  }

  static constexpr float kMost = 1e30f;
};

/// The box of a triangle's corners.
[[nodiscard]] inline Box3f boxOf(const Vec3f* corners) {
  Box3f box;
  box.lower = minVec3f(minVec3f(corners[0], corners[1]), corners[2]);
  box.upper = maxVec3f(maxVec3f(corners[0], corners[1]), corners[2]);
  return box;
}

}  // namespace tufa::reduce
