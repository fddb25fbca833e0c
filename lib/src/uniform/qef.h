#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "base/vec3.h"

namespace tufa::uniform {

using Vector = std::array<float, 3>;

[[nodiscard]] inline Vec3 toVec3(const Vector& v) { return {v[0], v[1], v[2]}; }

inline float dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A quadratic error function: the sum of squared distances to tangent planes, with the mean of the
/// points they were taken at (Ju, Losasso, Schaefer and Warren 2002).
///
/// Sums are additive as long as they share one origin; coordinates are in voxels and small (inside
/// a block), so that single precision serves at any distance from the grid's origin. Sixteen
/// floats, so that adding one to another is four vector instructions.
struct alignas(16) Qef {
  std::array<float, 6> a{};  ///< sum of n n^T: xx, xy, xz, yy, yz, zz
  Vector b{};                ///< sum of n (n . p)
  Vector points{};           ///< sum of p
  Vector normals{};          ///< sum of n
  float count = 0;

  Qef() = default;
  /// The plane through `point` with the unit normal `normal`.
  Qef(const Vector& point, const Vector& normal) : points(point), normals(normal), count(1) {
    const float offset = dot(point, normal);
    a = {normal[0] * normal[0], normal[0] * normal[1], normal[0] * normal[2],
         normal[1] * normal[1], normal[1] * normal[2], normal[2] * normal[2]};
    for (int i = 0; i < 3; ++i) b[i] = normal[i] * offset;
  }

  Qef& operator+=(const Qef& other) {
    for (int i = 0; i < 6; ++i) a[i] += other.a[i];
    for (int i = 0; i < 3; ++i) b[i] += other.b[i];
    for (int i = 0; i < 3; ++i) points[i] += other.points[i];
    for (int i = 0; i < 3; ++i) normals[i] += other.normals[i];
    count += other.count;
    return *this;
  }

  /// The same planes and points with the origin moved to `origin`.
  [[nodiscard]] Qef seenFrom(const Vector& origin) const {
    Qef moved = *this;
    moved.b[0] -= a[0] * origin[0] + a[1] * origin[1] + a[2] * origin[2];
    moved.b[1] -= a[1] * origin[0] + a[3] * origin[1] + a[4] * origin[2];
    moved.b[2] -= a[2] * origin[0] + a[4] * origin[1] + a[5] * origin[2];
    for (int i = 0; i < 3; ++i) moved.points[i] -= count * origin[i];
    return moved;
  }

  /// The mean squared distance from the planes of a point `step` away from one on all of them.
  [[nodiscard]] float meanSquare(const Vector& step) const {
    const Vector along = {a[0] * step[0] + a[1] * step[1] + a[2] * step[2],
                          a[1] * step[0] + a[3] * step[1] + a[4] * step[2],
                          a[2] * step[0] + a[4] * step[1] + a[5] * step[2]};
    return dot(along, step) / count;
  }

  /// Mean of the points; the count must not be 0.
  [[nodiscard]] Vector massPoint() const {
    const float share = 1 / count;
    return {points[0] * share, points[1] * share, points[2] * share};
  }
};

/// The point of the cube [-halfSize, halfSize]^3 around the origin with the least error. Directions
/// whose eigenvalue is under a hundredth of the largest count as free; along them the point stays
/// at the mass point. Where the unbounded solution leaves the cube, the problem is solved again on
/// the cube's faces, edges and corners. The mass point must lie in the cube and the count must not
/// be 0.
[[nodiscard]] Vector solve(const Qef& qef, float halfSize);

/// The point with the least error, as solve() has it where that is in the cube; nothing where it is
/// not, which costs a tenth of looking for the best point in the cube.
[[nodiscard]] std::optional<Vector> solveInside(const Qef& qef, float halfSize);

/// Solves `count` problems, each in the cube around an origin of its own: bit for bit
/// solutions[i] = solve(qefs[i].seenFrom(origins[i]), halfSize), but several at a time.
void solveAll(const Qef* qefs, const Vector* origins, std::size_t count, float halfSize,
              Vector* solutions);

}  // namespace tufa::uniform
