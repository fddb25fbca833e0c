#pragma once

#include <tufa/mesh.h>

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "octree/leaves.h"

namespace tufa::octree {

/// Where the cluster behind a vertex of a cut is in the forest.
struct ClusterRef {
  std::uint8_t level = 0;
  std::uint32_t cluster = 0;  ///< level 0: the uniform vertex; above: the cluster of its level
};

/// A cut of the forest: which cluster stands for each uniform vertex.
struct Cut {
  std::vector<VertexIndex> vertexOf;  ///< for each uniform vertex, the vertex of the cut
  std::vector<ClusterRef> clusters;   ///< for each vertex of the cut
};

/// Numbers the leaf clusters: first those in cells smaller than a block, in the order of their
/// uniform vertices, then those in cells of a block and more, from the largest down. The numbers
/// depend on the forest and the flags alone.
[[nodiscard]] Cut makeCut(const ClusterForest& forest, const uniform::CellTopology& topology,
                          const CellFlags& merged, base::Job& job);

}  // namespace tufa::octree
