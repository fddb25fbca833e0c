#include "check/frame.h"

#include <tufa/error.h>
#include <cmath>

namespace tufa::checks {

using openvdb::Vec3d;

Frame::Frame(const openvdb::GridBase& grid) {
  const openvdb::math::Transform& transform = grid.transform();
  if (!transform.isLinear()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + grid.getName() + "\" has a transform of type " + transform.mapType() +
                    "; only linear transforms are supported");
  }
  origin_ = transform.indexToWorld(Vec3d(0));
  openvdb::math::Mat3d linear;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d unit(0);
    unit[axis] = 1;
    linear.setCol(axis, transform.indexToWorld(unit) - origin_);
  }
  voxelSize_ = std::cbrt(std::abs(linear.det()));
  if (!std::isfinite(voxelSize_) || voxelSize_ == 0) {
    throw Error(ErrorCode::UnsupportedGrid,
                "the transform of grid \"" + grid.getName() + "\" has no inverse");
  }
  toVoxels_ = linear * (1 / voxelSize_);
  toIndex_ = toVoxels_.inverse();
  gradientFromIndex_ = toIndex_.transpose();
}

}  // namespace tufa::checks
