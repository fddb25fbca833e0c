#include "grid/voxel_frame.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <cmath>

#include "base/lattice_range.h"
#include "grid/vdb_coord.h"

namespace tufa::grid {

namespace {

std::array<Vec3, 3> rowsOf(const openvdb::math::Mat3d& matrix) {
  return {fromVdb(matrix.row(0)), fromVdb(matrix.row(1)), fromVdb(matrix.row(2))};
}

}  // namespace

VoxelFrame::VoxelFrame(const openvdb::GridBase& grid) {
  const openvdb::math::Transform& transform = grid.transform();
  if (!transform.isLinear()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + grid.getName() + "\" has a transform of type " + transform.mapType() +
                    "; only linear transforms are supported");
  }
  const openvdb::Vec3d origin = transform.indexToWorld(openvdb::Vec3d(0));
  openvdb::math::Mat3d linear;
  base::Lattice lattice{fromVdb(origin), {}};
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d unit(0);
    unit[axis] = 1;
    linear.setCol(axis, transform.indexToWorld(unit) - origin);
    lattice.steps[axis] = fromVdb(transform.baseMap()->applyJacobian(unit));
  }
  if (const std::string why = base::whyOutOfRange(lattice); !why.empty()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + grid.getName() + "\" cannot be used: " + why);
  }
  voxelSize_ = std::cbrt(std::abs(linear.det()));
  const openvdb::math::Mat3d toVoxels = linear * (1 / voxelSize_);
  const openvdb::math::Mat3d toIndex = toVoxels.inverse();
  origin_ = fromVdb(origin);
  toVoxels_ = rowsOf(toVoxels);
  toIndex_ = rowsOf(toIndex);
  gradientFromIndex_ = rowsOf(toIndex.transpose());
}

}  // namespace tufa::grid
