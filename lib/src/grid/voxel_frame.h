#pragma once

#include <tufa/openvdb_fwd.h>

#include <array>

#include "base/vec3.h"

namespace tufa::grid {

/// Voxel space: world space moved to the grid's index origin and scaled so that a voxel has
/// volume 1. A distance in it is a distance in voxels, in every direction, whatever the transform.
class VoxelFrame {
 public:
  /// A grid whose voxels are the world's units.
  VoxelFrame() = default;
  /// Throws Error(UnsupportedGrid) unless the transform is linear and in the range of
  /// base::whyOutOfRange().
  explicit VoxelFrame(const openvdb::GridBase& grid);

  /// World length of one voxel: the cube root of its volume.
  [[nodiscard]] double voxelSize() const { return voxelSize_; }

  [[nodiscard]] Vec3 fromWorld(const Position& p) const { return (p - origin_) / voxelSize_; }
  [[nodiscard]] Position toWorld(const Vec3& point) const { return point * voxelSize_ + origin_; }
  [[nodiscard]] Vec3 fromIndex(const Vec3& index) const { return times(toVoxels_, index); }
  [[nodiscard]] Vec3 toIndex(const Vec3& point) const { return times(toIndex_, point); }
  /// A gradient by index coordinates as one by voxel space.
  [[nodiscard]] Vec3 gradientFromIndex(const Vec3& gradient) const {
    return times(gradientFromIndex_, gradient);
  }

 private:
  using Matrix = std::array<Vec3, 3>;  ///< rows
  [[nodiscard]] static Vec3 times(const Matrix& rows, const Vec3& v) {
    return {rows[0].dot(v), rows[1].dot(v), rows[2].dot(v)};
  }
  static constexpr Matrix kIdentity = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};

  Vec3 origin_{0.0};
  double voxelSize_ = 1;
  Matrix toVoxels_ = kIdentity;
  Matrix toIndex_ = kIdentity;
  Matrix gradientFromIndex_ = kIdentity;
};

}  // namespace tufa::grid
