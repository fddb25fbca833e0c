#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

#include "octree/leaves.h"

namespace tufa::octree {

/// Where the cluster behind an output vertex is in the forest.
struct ClusterRef {
  std::uint8_t level = 0;
  std::uint16_t cell = 0;  ///< levels 0 to 2: the cell inside the block
  std::uint32_t parentCell =
      0;  ///< levels 0 to 2: the surface block; above: the cell of that level
  std::uint32_t cluster =
      0;  ///< level 0: the base vertex; above: the cluster of its level (and block)
};

/// A cut of the forest: which cluster stands for each base vertex.
struct Cut {
  std::vector<VertexIndex> vertexOf;  ///< for each base vertex, the vertex of the cut
  std::vector<ClusterRef> clusters;   ///< for each vertex of the cut
};

/// Numbers the leaf clusters: those of blocks first, in the order of their base vertices, then
/// those of larger cells, by level and cell.
[[nodiscard]] Cut makeCut(const Forest& forest, const uniform::Topology& topology,
                          const CellFlags& merged, base::Job& job);

}  // namespace tufa::octree
