#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>

namespace tufa::simplify {

/// The sum of squared distances to planes (Garland and Heckbert 1997), seen from a point of its
/// own near them, in world lengths.
struct PlaneSum {
  std::array<double, 6> a{};  ///< sum of n n^T: xx, xy, xz, yy, yz, zz
  openvdb::Vec3d b{0.0};      ///< sum of n (n . p)
  double c = 0;               ///< sum of (n . p)^2
  openvdb::Vec3d normals{0.0};
  double count = 0;

  /// The plane through `point` with unit normal `normal`.
  void addPlane(const openvdb::Vec3d& point, const openvdb::Vec3d& normal) {
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
  PlaneSum& operator+=(const PlaneSum& other) {
    for (int i = 0; i < 6; ++i) a[i] += other.a[i];
    b += other.b;
    c += other.c;
    normals += other.normals;
    count += other.count;
    return *this;
  }
  /// The same planes seen from `origin`.
  [[nodiscard]] PlaneSum seenFrom(const openvdb::Vec3d& origin) const {
    PlaneSum moved = *this;
    const openvdb::Vec3d shift = times(origin);
    moved.b -= shift;
    moved.c += origin.dot(shift) - 2 * origin.dot(b);
    return moved;
  }
  /// Sum of the squared distances of `x`.
  [[nodiscard]] double at(const openvdb::Vec3d& x) const {
    return std::max(0.0, x.dot(times(x)) - 2 * x.dot(b) + c);
  }
  /// The point of least error; directions that the planes leave free stay near the origin.
  [[nodiscard]] openvdb::Vec3d least() const;

 private:
  [[nodiscard]] openvdb::Vec3d times(const openvdb::Vec3d& x) const {
    return {a[0] * x[0] + a[1] * x[1] + a[2] * x[2], a[1] * x[0] + a[3] * x[1] + a[4] * x[2],
            a[2] * x[0] + a[4] * x[1] + a[5] * x[2]};
  }
};

}  // namespace tufa::simplify
