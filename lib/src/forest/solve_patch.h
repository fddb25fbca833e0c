#pragma once

#include "forest/forest.h"
#include "forest/patch.h"

namespace tufa::forest {

/// The vertex of a patch, its normal and its error. The cell reaches `size` voxels from `corner`,
/// both in the coordinates of the patch's planes.
[[nodiscard]] Cluster solvePatch(const Patch& patch, const openvdb::Vec3d& corner, int size,
                                 const base::Affine& affine);

}  // namespace tufa::forest
