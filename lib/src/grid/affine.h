#pragma once

#include <tufa/mesh.h>
#include <cmath>
#include <cstdint>

#include "base/vec3.h"
#include "grid/transform.h"

namespace tufa::grid {

/// A linear transform from index to world space, as matrices for fast evaluation. Positions are
/// counted from `origin`, a lattice point near the surface, so that they have the same digits
/// wherever in the world the grid lies; toWorld() moves them there.
class Affine {
 public:
  explicit Affine(const Transform& transform, const Coord& origin = Coord(0));

  /// Position of `cell` + (dx, dy, dz).
  [[nodiscard]] Position position(const Coord& cell, double dx, double dy, double dz) const {
    const double x = static_cast<double>(std::int64_t{cell[0]} - origin_[0]) + dx;
    const double y = static_cast<double>(std::int64_t{cell[1]} - origin_[1]) + dy;
    const double z = static_cast<double>(std::int64_t{cell[2]} - origin_[2]) + dz;
    return {m_[0][0] * x + m_[0][1] * y + m_[0][2] * z, m_[1][0] * x + m_[1][1] * y + m_[1][2] * z,
            m_[2][0] * x + m_[2][1] * y + m_[2][2] * z};
  }
  /// The position, counted from the world's origin.
  [[nodiscard]] Position toWorld(const Position& p) const {
    return {p.x + world_[0], p.y + world_[1], p.z + world_[2]};
  }
  /// Inverse of toWorld().
  [[nodiscard]] Position fromWorld(const Position& p) const {
    return {p.x - world_[0], p.y - world_[1], p.z - world_[2]};
  }
  /// Inverse of position(): lattice coordinates counted from `cell`.
  [[nodiscard]] Vec3 latticePoint(const Position& p, const Coord& cell) const {
    Vec3 at;
    for (int i = 0; i < 3; ++i) {
      at[i] = inverse_[i][0] * p.x + inverse_[i][1] * p.y + inverse_[i][2] * p.z -
              static_cast<double>(std::int64_t{cell[i]} - origin_[i]);
    }
    return at;
  }
  /// The world plane with unit normal `n`, as a covector of index space: its scalar product with a
  /// difference of lattice points is their distance along the normal, in voxels.
  [[nodiscard]] Vec3 planeInLattice(const Normal& n) const {
    Vec3 g;
    for (int i = 0; i < 3; ++i) {
      g[i] = (m_[0][i] * static_cast<double>(n.x) + m_[1][i] * static_cast<double>(n.y) +
              m_[2][i] * static_cast<double>(n.z)) /
             voxelSize_;
    }
    return g;
  }
  [[nodiscard]] const Coord& origin() const { return origin_; }
  /// World unit normal of an index-space gradient: by the inverse transpose.
  [[nodiscard]] Normal normal(float gx, float gy, float gz) const {
    const float x = normals_[0][0] * gx + normals_[0][1] * gy + normals_[0][2] * gz;
    const float y = normals_[1][0] * gx + normals_[1][1] * gy + normals_[1][2] * gz;
    const float z = normals_[2][0] * gx + normals_[2][1] * gy + normals_[2][2] * gz;
    const float squared = x * x + y * y + z * z;
    if (squared == 0) return {0, 0, 0};
    const float scale = 1 / std::sqrt(squared);
    return {x * scale, y * scale, z * scale};
  }
  /// World unit normal of a covector of index space, such as a sum of planeInLattice().
  [[nodiscard]] Normal normalOfPlane(const Vec3& g) const {
    return normal(static_cast<float>(g[0]), static_cast<float>(g[1]), static_cast<float>(g[2]));
  }
  /// World direction of an index-space axis.
  [[nodiscard]] Vec3 axis(int axis) const { return {m_[0][axis], m_[1][axis], m_[2][axis]}; }
  /// World length of a voxel: the cube root of its volume.
  [[nodiscard]] double voxelSize() const { return voxelSize_; }
  /// World distance between the two faces of a voxel that are nearest to each other.
  [[nodiscard]] double leastHeight() const;
  /// Whether the transform mirrors: right-handed becomes left-handed.
  [[nodiscard]] bool mirrored() const { return mirrored_; }

 private:
  Coord origin_;
  double m_[3][3];
  double inverse_[3][3];
  double world_[3];  ///< world position of origin_
  float normals_[3][3];
  double voxelSize_;
  bool mirrored_;
};

}  // namespace tufa::grid
