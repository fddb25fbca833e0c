#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "base/vec3.h"

namespace tufa::base {

/// A ray turned and sheared so that it runs along z: both triangles at an edge then see the same
/// numbers, and none is passed between them (Woop, Benthin and Wald 2013).
class ShearedRay {
 public:
  /// The direction may have any length but 0.
  ShearedRay(const Vec3& origin, const Vec3& direction) : origin_(origin) {
    const Vec3& d = direction;
    for (std::size_t axis = 1; axis < 3; ++axis) {
      if (std::abs(d[axis]) > std::abs(d[z_])) z_ = axis;
    }
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    if (d[z_] < 0) std::swap(x_, y_);
    shearX_ = d[x_] / d[z_];
    shearY_ = d[y_] / d[z_];
    scale_ = 1 / d[z_];
  }

  /// Where it passes a triangle, on either side: in lengths of the direction. Of an edge that it
  /// passes both triangles tell.
  [[nodiscard]] std::optional<double> passes(const std::array<Vec3, 3>& corners) const {
    std::array<Vec3, 3> p;
    for (std::size_t n = 0; n < 3; ++n) p[n] = sheared(corners[n]);
    const std::array<double, 3> shares{share(p[2], p[1]), share(p[0], p[2]), share(p[1], p[0])};
    const bool below = shares[0] < 0 || shares[1] < 0 || shares[2] < 0;
    const bool above = shares[0] > 0 || shares[1] > 0 || shares[2] > 0;
    const double sum = shares[0] + shares[1] + shares[2];
    if ((below && above) || sum == 0) return std::nullopt;
    return (shares[0] * p[0][2] + shares[1] * p[1][2] + shares[2] * p[2][2]) / sum;
  }

 private:
  [[nodiscard]] Vec3 sheared(const Vec3& corner) const {
    const Vec3 v = corner - origin_;
    return {v[x_] - shearX_ * v[z_], v[y_] - shearY_ * v[z_], scale_ * v[z_]};
  }
  static double share(const Vec3& a, const Vec3& b) { return a[0] * b[1] - a[1] * b[0]; }

  Vec3 origin_;
  std::size_t x_ = 1, y_ = 2, z_ = 0;
  double shearX_ = 0, shearY_ = 0, scale_ = 1;
};

}  // namespace tufa::base
