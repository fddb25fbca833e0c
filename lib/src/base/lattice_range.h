#pragma once

#include <array>
#include <string>

#include "base/vec3.h"

namespace tufa::base {

/// Where the lattice points of a grid lie: that of index 0, and the steps along the three axes, in
/// world space.
struct Lattice {
  Vec3 origin;
  std::array<Vec3, 3> steps;
};

/// Why a surface on that lattice cannot be computed, with what to do about it; nothing if it can.
/// Within the range, positions and distances fit single precision with room for products of two,
/// and a double tells 4096 places apart along each voxel.
[[nodiscard]] std::string whyOutOfRange(const Lattice& lattice);

/// Throws Error(InvalidArgument) unless grids can be made with voxels of that size.
void requireVoxelSize(double voxelSize);

/// Voxels on either side of the surface in the widest narrow band that is made.
inline constexpr double kMostHalfWidth = 1000;

/// Whether narrow bands can be made that wide.
[[nodiscard]] constexpr bool isHalfWidth(double voxels) {
  return voxels >= 1 && voxels <= kMostHalfWidth;
}

/// Throws Error(InvalidArgument) unless narrow bands can be made that wide.
void requireHalfWidth(double halfWidth);

}  // namespace tufa::base
