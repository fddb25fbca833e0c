#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/vec3.h"

namespace tufa::base {

/// A vector or point in single precision, for loops that are bound by memory. Coordinates should be
/// counted from a place nearby: 1000 voxels from it, a float is exact to 1/16000 voxel.
struct Vec3f {
  float x = 0;
  float y = 0;
  float z = 0;

  Vec3f() = default;
  constexpr Vec3f(float px, float py, float pz) : x(px), y(py), z(pz) {}
  explicit Vec3f(const Vec3& v)
      : x(static_cast<float>(v[0])), y(static_cast<float>(v[1])), z(static_cast<float>(v[2])) {}
  explicit operator Vec3() const { return {x, y, z}; }

  float& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  const float& operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

  friend Vec3f operator+(const Vec3f& a, const Vec3f& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Vec3f operator-(const Vec3f& a, const Vec3f& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend Vec3f operator*(const Vec3f& a, float factor) {
    return {a.x * factor, a.y * factor, a.z * factor};
  }
  friend bool operator==(const Vec3f&, const Vec3f&) = default;
};

// Sums run from x to z, as those of Vec3.

[[nodiscard]] inline float dot(const Vec3f& a, const Vec3f& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline Vec3f cross(const Vec3f& a, const Vec3f& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline float squaredLength(const Vec3f& a) { return dot(a, a); }
[[nodiscard]] inline float length(const Vec3f& a) { return std::sqrt(dot(a, a)); }

/// Scaled to length 1; 0 stays 0.
[[nodiscard]] inline Vec3f unit(const Vec3f& a) {
  const float was = length(a);
  return was > 0 ? a * (1 / was) : Vec3f();
}

/// Any two unit vectors that stand on `axis`, a unit vector, and on each other.
struct Frame {
  Vec3f x;
  Vec3f y;
};
[[nodiscard]] inline Frame frameAbout(const Vec3f& axis) {
  const Vec3f x = unit(std::abs(axis.x) < 0.6f ? cross(axis, {1, 0, 0}) : cross(axis, {0, 1, 0}));
  return {x, cross(axis, x)};
}

/// The smaller and the larger coordinate along each axis.
[[nodiscard]] inline Vec3f minVec3f(const Vec3f& a, const Vec3f& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
[[nodiscard]] inline Vec3f maxVec3f(const Vec3f& a, const Vec3f& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

}  // namespace tufa::base
