#include "grid/transform.h"

#include <openvdb/openvdb.h>

#include "grid/vdb_coord.h"

namespace tufa::grid {

Transform::Transform(const openvdb::math::Transform& transform) : transform_(transform.copy()) {}

Vec3 Transform::indexToWorld(const Vec3& index) const {
  return fromVdb(transform_->indexToWorld(toVdb(index)));
}

Vec3 Transform::worldToIndex(const Vec3& world) const {
  return fromVdb(transform_->worldToIndex(toVdb(world)));
}

std::array<std::array<double, 4>, 4> Transform::matrix() const {
  const openvdb::Mat4d own = transform_->baseMap()->getAffineMap()->getMat4();
  std::array<std::array<double, 4>, 4> matrix{};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) matrix[row][column] = own[row][column];
  }
  return matrix;
}

Transform transformOf(const openvdb::GridBase& grid) { return Transform(grid.transform()); }

}  // namespace tufa::grid
