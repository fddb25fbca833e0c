#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "base/vec3.h"
#include "grid/affine.h"
#include "grid/vdb_coord.h"

namespace tufa::rays {

/// Reads the trilinear interpolant of a grid, for one thread. The tree must not change meanwhile.
template <class GridT>
class Interpolant {
 public:
  explicit Interpolant(const GridT& grid) : accessor_(grid.getConstUnsafeAccessor()) {}

  /// Corner n of a cell is at (n & 1, n >> 1 & 1, n >> 2) from it.
  [[nodiscard]] std::array<double, 8> corners(const openvdb::Coord& cell) const {
    std::array<double, 8> values;
    for (int n = 0; n < 8; ++n) {
      values[n] = accessor_.getValue(cell.offsetBy(n & 1, n >> 1 & 1, n >> 2));
    }
    return values;
  }

  static double mixed(const std::array<double, 8>& v, const Vec3& share) {
    const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
    const double low = mix(mix(v[0], v[1], share[0]), mix(v[2], v[3], share[0]), share[1]);
    const double high = mix(mix(v[4], v[5], share[0]), mix(v[6], v[7], share[0]), share[1]);
    return mix(low, high, share[2]);
  }

  [[nodiscard]] double at(const Vec3& index) const {
    const openvdb::Coord cell = grid::toVdb(floorCoord(index));
    return mixed(corners(cell), index - Vec3(cell.x(), cell.y(), cell.z()));
  }

  /// By differences over a voxel, which smooths the edges of cells. In steps of the index.
  [[nodiscard]] Vec3 gradient(const Vec3& index) const {
    Vec3 slope(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 step(0.0);
      step[axis] = 0.5;
      const double rise = at(index + step) - at(index - step);
      slope[axis] = std::isfinite(rise) ? rise : 0;
    }
    return slope;
  }

  [[nodiscard]] bool isActive(const openvdb::Coord& at) const { return accessor_.isValueOn(at); }

 private:
  typename GridT::ConstUnsafeAccessor accessor_;
};

/// The unit normal at a place of the index space, outward.
template <class GridT>
Normal normalAt(const Interpolant<GridT>& values, const grid::Affine& affine, const Vec3& index,
                bool insideIsBelow) {
  // The longest component first: densities may be tiny.
  Vec3 slope = values.gradient(index) * (insideIsBelow ? 1 : -1);
  const double longest = std::max({std::abs(slope[0]), std::abs(slope[1]), std::abs(slope[2])});
  if (!(longest > 0)) return {0, 0, 0};
  slope /= longest;
  return affine.normal(static_cast<float>(slope[0]), static_cast<float>(slope[1]),
                       static_cast<float>(slope[2]));
}

}  // namespace tufa::rays
