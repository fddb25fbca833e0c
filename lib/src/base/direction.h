#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec3f.h"

namespace tufa::base {

/// A unit vector in four bytes, or none: its place on an octahedron unfolded to a square (Cigolle
/// et al., "A Survey of Efficient Representations for Independent Unit Vectors", 2014). Within
/// 1e-4 radians of the vector that it was made of; along axes and halfway between two of them it
/// is exact up to rounding.
class Direction {
 public:
  /// None.
  Direction() = default;
  /// That of a vector of any length; none if that is 0 or not finite.
  explicit Direction(const Vec3f& v) {
    const float size = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
    if (!(size > 0) || !std::isfinite(size)) return;
    float x = v.x / size, y = v.y / size;
    if (v.z < 0) fold(x, y);
    x_ = rounded(x), y_ = rounded(y);
  }

  [[nodiscard]] bool isNone() const { return x_ == kNone; }
  /// Of length 1, or 0 if there is none.
  [[nodiscard]] Vec3f vector() const {
    if (isNone()) return {};
    float x = static_cast<float>(x_) / kScale, y = static_cast<float>(y_) / kScale;
    const float z = 1 - std::abs(x) - std::abs(y);
    if (z < 0) fold(x, y);
    return unit({x, y, z});
  }
  friend bool operator==(const Direction&, const Direction&) = default;

 private:
  // Even, so that halves are whole numbers.
  static constexpr float kScale = 32766;
  static constexpr std::int16_t kNone = -32768;

  static std::int16_t rounded(float x) {
    return static_cast<std::int16_t>(x * kScale + std::copysign(0.5f, x));
  }
  // Takes the octahedron's lower half to the corners of the square, and back.
  static void fold(float& x, float& y) {
    const float u = std::copysign(1 - std::abs(y), x), v = std::copysign(1 - std::abs(x), y);
    x = u, y = v;
  }

  std::int16_t x_ = kNone;
  std::int16_t y_ = kNone;
};

}  // namespace tufa::base
