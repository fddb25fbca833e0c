#pragma once

#include <openvdb/openvdb.h>

#include <tufa/mesh.h>

namespace tufa::checks {

/// Voxel space: world space moved to the grid's index origin and scaled so that a voxel has
/// volume 1. A distance in it is a distance in voxels, in every direction, whatever the transform.
class Frame {
 public:
  /// Throws Error (UnsupportedGrid) unless the transform is linear and has an inverse.
  explicit Frame(const openvdb::GridBase& grid);

  /// World length of one voxel: the cube root of its volume.
  [[nodiscard]] double voxelSize() const { return voxelSize_; }

  [[nodiscard]] openvdb::Vec3d fromWorld(const Position& p) const {
    return (openvdb::Vec3d(p.x, p.y, p.z) - origin_) / voxelSize_;
  }
  [[nodiscard]] openvdb::Vec3d fromIndex(const openvdb::Vec3d& index) const {
    return toVoxels_ * index;
  }
  [[nodiscard]] openvdb::Vec3d toIndex(const openvdb::Vec3d& point) const {
    return toIndex_ * point;
  }
  /// A gradient by index coordinates as one by voxel space.
  [[nodiscard]] openvdb::Vec3d gradientFromIndex(const openvdb::Vec3d& gradient) const {
    return gradientFromIndex_ * gradient;
  }

 private:
  openvdb::Vec3d origin_;
  double voxelSize_ = 1;
  openvdb::math::Mat3d toVoxels_;
  openvdb::math::Mat3d toIndex_;
  openvdb::math::Mat3d gradientFromIndex_;
};

}  // namespace tufa::checks
