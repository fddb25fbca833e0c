#pragma once

#include <openvdb/openvdb.h>

#include <tufa/mesh.h>

namespace tufa::base {

/// A linear transform from index to world space, taken apart for speed.
class Affine {
 public:
  explicit Affine(const openvdb::math::Transform& transform);

  /// World position of `cell` + `offset`; the two are added in double, so a far cell keeps the
  /// offset's digits.
  [[nodiscard]] Position position(const openvdb::Coord& cell, double dx, double dy,
                                  double dz) const {
    const double x = cell[0] + dx, y = cell[1] + dy, z = cell[2] + dz;
    return {m_[0][0] * x + m_[0][1] * y + m_[0][2] * z + t_[0],
            m_[1][0] * x + m_[1][1] * y + m_[1][2] * z + t_[1],
            m_[2][0] * x + m_[2][1] * y + m_[2][2] * z + t_[2]};
  }
  /// World unit normal of an index-space gradient: by the inverse transpose.
  [[nodiscard]] Normal normal(float gx, float gy, float gz) const;
  /// World direction of an index-space axis.
  [[nodiscard]] openvdb::Vec3d axis(int axis) const {
    return {m_[0][axis], m_[1][axis], m_[2][axis]};
  }
  /// World length of a voxel: the cube root of its volume.
  [[nodiscard]] double voxelSize() const { return voxelSize_; }
  /// The transform turns right-handed into left-handed.
  [[nodiscard]] bool mirrored() const { return mirrored_; }

 private:
  double m_[3][3];
  double t_[3];
  float normals_[3][3];
  double voxelSize_;
  bool mirrored_;
};

}  // namespace tufa::base
