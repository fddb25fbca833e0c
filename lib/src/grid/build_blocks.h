#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>

#include "base/job.h"

namespace tufa::grid {

/// What buildBlocks() needs of a volume. All functions are called from several threads at a time.
struct BlockSource {
  /// Half the side, in voxels, of the cube around the origin that holds all values.
  int halfExtentVoxels = 0;
  /// Whether a cube of voxels may hold active values.
  std::function<bool(const openvdb::Coord& origin, int side)> mayBeActive;
  /// Fills the leaf at `leaf.origin()`; leaves without active values are dropped afterwards.
  std::function<void(openvdb::FloatTree::LeafNodeType& leaf)> fill;
  /// If given: a source that gives the same in a cube, and is quicker there; null for this one,
  /// which must outlive it otherwise.
  std::function<std::shared_ptr<const BlockSource>(const openvdb::Coord& origin, int side)>
      narrowed;
  /// More cubes of 64^3 voxels that may hold active values are refused as LimitExceeded.
  std::size_t mostCubes = std::numeric_limits<std::size_t>::max();
};

/// Builds the leaves of a volume top-down and in parallel, as the stage of `job` that was begun.
/// The tree is the same for any number of threads.
void buildBlocks(openvdb::FloatTree& tree, const BlockSource& source, base::Job& job);

/// Voxels from the origin to cover a world length, with `margin` to spare. Throws
/// Error(InvalidArgument) if the grid's coordinates would overflow.
[[nodiscard]] int extentInVoxels(double worldLength, double voxelSize, double margin);

}  // namespace tufa::grid
