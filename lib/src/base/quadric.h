#pragma once

#include <algorithm>
#include <array>

#include "base/vec3.h"

namespace tufa::base {

/// A quadric error function: the sum of squared distances to the planes gathered so far (Garland
/// and Heckbert 1997). Additive. In double precision, and with an origin near the planes, so that
/// the error at the solution is not lost in rounding.
struct Quadric {
  std::array<double, 6> a{};  ///< sum of n n^T: xx, xy, xz, yy, yz, zz
  Vec3 b{0.0};                ///< sum of n (n . p)
  double c = 0;               ///< sum of (n . p)^2
  Vec3 normals{0.0};          ///< sum of n
  double count = 0;           ///< of planes

  /// The plane through `point`; distances are measured along `normal`, in its lengths.
  void addPlane(const Vec3& point, const Vec3& normal) {
    const double offset = point.dot(normal);
    a[0] += normal[0] * normal[0];
    a[1] += normal[0] * normal[1];
    a[2] += normal[0] * normal[2];
    a[3] += normal[1] * normal[1];
    a[4] += normal[1] * normal[2];
    a[5] += normal[2] * normal[2];
    b += normal * offset;
    c += offset * offset;
    normals += normal;
    count += 1;
  }
  Quadric& operator+=(const Quadric& other) {
    for (int i = 0; i < 6; ++i) a[i] += other.a[i];
    b += other.b;
    c += other.c;
    normals += other.normals;
    count += other.count;
    return *this;
  }
  /// The same planes in coordinates counted from `origin`.
  [[nodiscard]] Quadric translatedTo(const Vec3& origin) const {
    Quadric moved = *this;
    const Vec3 shift = times(origin);
    moved.b -= shift;
    moved.c += origin.dot(shift) - 2 * origin.dot(b);
    return moved;
  }
  /// Sum of the squared distances of `x`.
  [[nodiscard]] double at(const Vec3& x) const {
    return std::max(0.0, x.dot(times(x)) - 2 * x.dot(b) + c);
  }
  [[nodiscard]] Vec3 times(const Vec3& x) const {
    return {a[0] * x[0] + a[1] * x[1] + a[2] * x[2], a[1] * x[0] + a[3] * x[1] + a[4] * x[2],
            a[2] * x[0] + a[4] * x[1] + a[5] * x[2]};
  }
};

}  // namespace tufa::base
