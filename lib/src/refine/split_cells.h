#pragma once

#include <vector>

#include "octree/cluster_forest.h"
#include "octree/cut.h"
#include "octree/leaves.h"

namespace tufa::refine {

/// Forbids the cells above `minLevel` of some vertices of a cut. True if there are any: the next
/// cut will be finer.
bool splitCells(const octree::ClusterForest& forest, const std::vector<VertexIndex>& vertices,
                const octree::Cut& cut, int minLevel, octree::CellFlags& forbidden);

}  // namespace tufa::refine
