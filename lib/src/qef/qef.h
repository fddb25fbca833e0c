#pragma once

#include <array>

namespace tufa::qef {

using Vector = std::array<float, 3>;

inline float dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A quadratic error function: the sum of squared distances to tangent planes, with the mean of the
/// points they were taken at (Ju, Losasso, Schaefer and Warren 2002).
///
/// Coordinates are in voxels from the middle of the cell, so that single precision serves at any
/// distance from the origin. Sums are additive as long as they share that middle.
struct Qef {
  std::array<float, 6> a{};  ///< sum of n n^T: xx, xy, xz, yy, yz, zz
  Vector b{};                ///< sum of n (n . p)
  Vector points{};           ///< sum of p
  Vector normals{};          ///< sum of n
  float count = 0;

  /// Adds the plane through `point` with the unit normal `normal`.
  void add(const Vector& point, const Vector& normal) {
    const float offset = dot(point, normal);
    a[0] += normal[0] * normal[0];
    a[1] += normal[0] * normal[1];
    a[2] += normal[0] * normal[2];
    a[3] += normal[1] * normal[1];
    a[4] += normal[1] * normal[2];
    a[5] += normal[2] * normal[2];
    for (int i = 0; i < 3; ++i) {
      b[i] += normal[i] * offset;
      points[i] += point[i];
      normals[i] += normal[i];
    }
    count += 1;
  }

  /// Mean of the points; the count must not be 0.
  [[nodiscard]] Vector massPoint() const {
    return {points[0] / count, points[1] / count, points[2] / count};
  }
};

/// The point of the cube [-halfSize, halfSize]^3 with the least error, as near to the mass point as
/// the planes leave free: directions whose eigenvalue is under a hundredth of the largest count as
/// free. Where the unbounded solution leaves the cube, the problem is solved again on the cube's
/// faces, edges and corners. The mass point must lie in the cube and the count must not be 0.
[[nodiscard]] Vector solve(const Qef& qef, float halfSize);

}  // namespace tufa::qef
