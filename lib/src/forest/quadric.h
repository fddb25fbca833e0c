#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>

#include "qef/qef.h"

namespace tufa::forest {

/// A quadratic error function with its constant term: the sum of squared distances, in voxels, to
/// the tangent planes gathered so far. Additive; coordinates are lattice coordinates of one cell,
/// in double, so that the error at the solution does not drown in the sums of a large cell.
struct Quadric {
  std::array<double, 6> a{};  ///< sum of n n^T: xx, xy, xz, yy, yz, zz
  openvdb::Vec3d b{0.0};      ///< sum of n (n . p)
  double c = 0;               ///< sum of (n . p)^2
  openvdb::Vec3d points{0.0};
  openvdb::Vec3d normals{0.0};
  double planeCount = 0;
  double pointCount = 0;

  /// `normal` measures distance in voxels; see base::Affine::planeInLattice().
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
    planeCount += 1;
  }
  void addPoint(const openvdb::Vec3d& point) {
    points += point;
    pointCount += 1;
  }

  Quadric& operator+=(const Quadric& other) {
    for (int i = 0; i < 6; ++i) a[i] += other.a[i];
    b += other.b;
    c += other.c;
    points += other.points;
    normals += other.normals;
    planeCount += other.planeCount;
    pointCount += other.pointCount;
    return *this;
  }

  [[nodiscard]] openvdb::Vec3d times(const openvdb::Vec3d& x) const {
    return {a[0] * x[0] + a[1] * x[1] + a[2] * x[2], a[1] * x[0] + a[3] * x[1] + a[4] * x[2],
            a[2] * x[0] + a[4] * x[1] + a[5] * x[2]};
  }
  /// The same planes seen from `origin`.
  [[nodiscard]] Quadric seenFrom(const openvdb::Vec3d& origin) const {
    Quadric moved = *this;
    const openvdb::Vec3d shift = times(origin);
    moved.b -= shift;
    moved.c += origin.dot(shift) - 2 * origin.dot(b);
    moved.points -= origin * pointCount;
    return moved;
  }
  /// Mean squared distance of `x` to the planes.
  [[nodiscard]] double meanSquare(const openvdb::Vec3d& x) const {
    if (planeCount == 0) return 0;
    return std::max(0.0, x.dot(times(x)) - 2 * x.dot(b) + c) / planeCount;
  }
  /// The same problem with lengths divided by `size`, for qef::solve().
  [[nodiscard]] qef::Qef scaledBy(double size) const {
    qef::Qef scaled;
    for (int i = 0; i < 6; ++i) scaled.a[i] = static_cast<float>(a[i]);
    const double planesPerPoint = planeCount / pointCount;
    for (int i = 0; i < 3; ++i) {
      scaled.b[i] = static_cast<float>(b[i] / size);
      scaled.points[i] = static_cast<float>(points[i] / size * planesPerPoint);
      scaled.normals[i] = static_cast<float>(normals[i]);
    }
    scaled.count = static_cast<float>(planeCount);
    return scaled;
  }
};

}  // namespace tufa::forest
