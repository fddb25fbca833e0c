#pragma once

#include "base/quadric.h"
#include "uniform/qef.h"

namespace tufa::octree {

/// The tangent planes that a cluster has gathered, and the points they were gathered at. Lengths
/// are voxels, coordinates those of the lattice.
struct PatchPlanes : base::Quadric {
  Vec3 points{0.0};  ///< sum of the points
  double pointCount = 0;

  void addPoint(const Vec3& point) {
    points += point;
    pointCount += 1;
  }
  PatchPlanes& operator+=(const PatchPlanes& other) {
    Quadric::operator+=(other);
    points += other.points;
    pointCount += other.pointCount;
    return *this;
  }
  /// The same planes and points in coordinates counted from `origin`.
  [[nodiscard]] PatchPlanes translatedTo(const Vec3& origin) const {
    return {Quadric::translatedTo(origin), points - origin * pointCount, pointCount};
  }
  /// Mean squared distance of `x` to the planes.
  [[nodiscard]] double meanSquare(const Vec3& x) const { return count == 0 ? 0 : at(x) / count; }
  /// The same problem with lengths divided by `size`, for uniform::solve(). Qef::massPoint()
  /// divides by the number of planes; so the sum of the points is scaled to that number.
  [[nodiscard]] uniform::Qef scaledBy(double size) const {
    uniform::Qef scaled;
    for (int i = 0; i < 6; ++i) scaled.a[i] = static_cast<float>(a[i]);
    const double planesPerPoint = count / pointCount;
    for (int i = 0; i < 3; ++i) {
      scaled.b[i] = static_cast<float>(b[i] / size);
      scaled.points[i] = static_cast<float>(points[i] / size * planesPerPoint);
      scaled.normals[i] = static_cast<float>(normals[i]);
    }
    scaled.count = static_cast<float>(count);
    return scaled;
  }
};

}  // namespace tufa::octree
