#pragma once

#include <openvdb/openvdb.h>

#include <tufa/shapes.h>
#include <functional>

#include "shapes/distance_field.h"

namespace tufa::shapes {

/// What buildBlocks() needs of a volume. Both functions are called from several threads at a time.
struct BlockSource {
  /// Half the side, in voxels, of the cube around the origin that holds all values.
  int halfExtentVoxels = 0;
  /// Whether a cube of voxels may hold active values.
  std::function<bool(const openvdb::Coord& origin, int side)> mayBeActive;
  /// Fills the leaf at `leaf.origin()`; leaves without active values are dropped afterwards.
  std::function<void(openvdb::FloatTree::LeafNodeType& leaf)> fill;
};

/// Builds the leaves of a volume top-down and in parallel. The tree is the same for any number of
/// threads. `stage` is what the progress says.
void buildBlocks(openvdb::FloatTree& tree, const BlockSource& source, const ShapeOptions& options);

/// Voxels from the origin to cover a world length, with `margin` to spare. Throws
/// Error(InvalidArgument) if the grid's coordinates would overflow.
[[nodiscard]] int extentInVoxels(double worldLength, double voxelSize, double margin);

/// Samples a field as a narrow-band level set, with the values of tiles and inactive voxels clamped
/// to the band on their side of the surface.
[[nodiscard]] openvdb::FloatGrid::Ptr sampleLevelSet(const DistanceField& field,
                                                     const ShapeOptions& options);

}  // namespace tufa::shapes
