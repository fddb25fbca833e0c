#pragma once

#include <vector>

#include "distance/certifier.h"
#include "octree/cluster_forest.h"
#include "octree/cut.h"
#include "octree/leaves.h"

namespace tufa::refine {

/// Forbids the cells above `minLevel` of some vertices of a cut. True if there are any: the next
/// cut will be finer.
bool splitCells(const octree::ClusterForest& forest, const std::vector<VertexIndex>& vertices,
                const octree::Cut& cut, int minLevel, octree::CellFlags& forbidden);

/// The vertices whose cells must be split for the tolerance: those of polygons that are too far,
/// and those that stand for uniform points that are.
[[nodiscard]] std::vector<VertexIndex> tooCoarse(const Mesh& base, const octree::Cut& cut,
                                                 const distance::Deviation& deviation);

}  // namespace tufa::refine
