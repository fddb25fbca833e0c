#pragma once

#include <array>

#include "grid/isovalue.h"
#include "grid/stored_grid.h"

namespace tufa::grid {

/// How raw values are read: as distances in voxels, negative inside, where a voxel is the cube root
/// of its world volume.
struct FieldScale {
  double isovalue = 0;
  /// What values are multiplied with; negative where inside is above. Of a distance the voxels in a
  /// unit of value; of other fields a power of two beside it where values are very large or small.
  double factor = 1;
  /// The field is a distance: its gradient has length 1. Creases can be restored from it.
  bool distance = false;
  /// The field is a level set that holds distances only inside its band: samples at or beyond these
  /// values only tell their side, and a jump of more than a voxel between an active sample and an
  /// inactive one is the edge of the data, not surface.
  bool narrowBand = false;
  float bandInside = -3e38F;  ///< least value that is a distance, after scaling
  float bandOutside = 3e38F;  ///< greatest one
  /// Squared length of an index-space gradient g: the quadratic form with these entries, in the
  /// order xx, xy, xz, yy, yz, zz. The identity for cubic voxels.
  std::array<float, 6> metric{1, 0, 0, 1, 0, 1};
  /// World length of a step along each axis, in voxels.
  std::array<double, 3> axisLength{1, 1, 1};

  [[nodiscard]] float squaredLength(float x, float y, float z) const {
    return metric[0] * x * x + metric[3] * y * y + metric[5] * z * z +
           2 * (metric[1] * x * y + metric[2] * x * z + metric[4] * y * z);
  }
};

/// The farthest that a distance can change in a step of length 1, in voxels, with a margin for
/// rounding.
inline constexpr double kLongestStep = 1.02;

/// Decides from a sample of the grid's leaves whether the field is a distance. The grid's transform
/// must be linear.
[[nodiscard]] FieldScale readFieldScale(const StoredGrid& grid, const IsoChoice& iso);

}  // namespace tufa::grid
