#pragma once

#include "base/vec3.h"
#include "grid/affine.h"
#include "octree/cluster_forest.h"
#include "octree/patch.h"

namespace tufa::octree {

/// The vertex of a patch, its normal and its error. The cell reaches `size` voxels from `corner`,
/// both in the coordinates of the patch's planes.
[[nodiscard]] Cluster solvePatch(const Patch& patch, const Vec3& corner, int size,
                                 const grid::Affine& affine);

}  // namespace tufa::octree
