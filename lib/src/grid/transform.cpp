#include "grid/transform.h"

#include <openvdb/openvdb.h>

#include <cmath>
#include <memory>

#include "grid/vdb_coord.h"

namespace tufa::grid {

// Shares the map, which never changes: a copy of one has steps that have lost the digits of its
// translation.
Transform::Transform(const openvdb::math::Transform& transform)
    : transform_(std::make_shared<openvdb::math::Transform>(transform)) {}

Vec3 Transform::indexToWorld(const Vec3& index) const {
  return fromVdb(transform_->indexToWorld(toVdb(index)));
}

Vec3 Transform::worldToIndex(const Vec3& world) const {
  return fromVdb(transform_->worldToIndex(toVdb(world)));
}

base::Lattice Transform::lattice() const {
  base::Lattice lattice{fromVdb(transform_->indexToWorld(openvdb::Vec3d(0))), {}};
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d unit(0);
    unit[axis] = 1;
    lattice.steps[axis] = fromVdb(transform_->baseMap()->applyJacobian(unit));
  }
  return lattice;
}

std::array<std::array<double, 4>, 4> Transform::matrix() const {
  std::array<std::array<double, 4>, 4> matrix{};
  const openvdb::Name type = transform_->mapType();
  if (type == openvdb::math::AffineMap::mapType() || type == openvdb::math::UnitaryMap::mapType()) {
    const openvdb::Mat4d own = transform_->baseMap()->getAffineMap()->getMat4();
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) matrix[row][column] = own[row][column];
    }
    return matrix;
  }
  // Maps along the axes. OpenVDB makes no affine map of small ones. + 0.0: no -0.
  const base::Lattice own = lattice();
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) matrix[row][column] = own.steps[row][column] + 0.0;
    matrix[3][column] = own.origin[column] + 0.0;
  }
  matrix[3][3] = 1;
  return matrix;
}

Transform transformOf(const openvdb::GridBase& grid) { return Transform(grid.transform()); }

std::vector<Coord> cellsOf(const std::vector<Position>& positions, const Transform& transform,
                           base::Job& job) {
  std::vector<Coord> cells(positions.size());
  job.forRanges(positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 index = transform.worldToIndex(positions[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        cells[i][axis] = static_cast<std::int32_t>(std::floor(index[axis]));
      }
    }
  });
  return cells;
}

}  // namespace tufa::grid
