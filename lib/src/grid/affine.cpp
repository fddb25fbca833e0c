#include "grid/affine.h"

#include <openvdb/math/Mat3.h>

#include <algorithm>
#include <cmath>

#include "grid/vdb_coord.h"

namespace tufa::grid {

Affine::Affine(const Transform& transform, const Coord& origin) : origin_(origin) {
  const Vec3 start = transform.indexToWorld(Vec3(origin));
  const base::Lattice lattice = transform.lattice();
  openvdb::math::Mat3d linear;
  for (int axis = 0; axis < 3; ++axis) linear.setCol(axis, toVdb(lattice.steps[axis]));
  const double size = std::cbrt(std::abs(linear.det()));
  const openvdb::math::Mat3d inverse = linear.inverse();
  for (int i = 0; i < 3; ++i) {
    world_[i] = start[i];
    for (int j = 0; j < 3; ++j) {
      m_[i][j] = linear(i, j);
      inverse_[i][j] = inverse(i, j);
      // The inverse transpose, scaled to the size of a rotation so that single precision serves.
      normals_[i][j] = static_cast<float>(inverse(j, i) * size);
    }
  }
  voxelSize_ = size;
  mirrored_ = linear.det() < 0;
}

double Affine::leastHeight() const {
  const double volume = std::abs(axis(0).dot(axis(1).cross(axis(2))));
  double largestFace = 0;
  for (int i = 0; i < 3; ++i) {
    largestFace = std::max(largestFace, axis(i).cross(axis((i + 1) % 3)).length());
  }
  return volume / largestFace;
}

}  // namespace tufa::grid
