#pragma once

#include <tufa/octree.h>

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "octree/cluster_forest.h"
#include "octree/cut_rule.h"
#include "uniform/cell_topology.h"

namespace tufa::octree {

/// A flag for each cell of a forest.
struct CellFlags {
  std::vector<std::vector<std::uint8_t>> levels;  ///< as ClusterForest::levels

  explicit CellFlags(const ClusterForest& forest);
  /// The flags of the cells of a level.
  [[nodiscard]] std::vector<std::uint8_t>& at(int level) { return levels[level - 1]; }
  [[nodiscard]] const std::vector<std::uint8_t>& at(int level) const { return levels[level - 1]; }
};

/// The cells that a cut merges: the leaves of a restricted octree, and all cells below them. A cell
/// is merged if it is safe, keeps the rule, is not forbidden, its children are merged, and so are
/// all surface cells of its children's size that touch it. So no two leaves that touch differ by
/// more than one level (those of different chunks may), and no coarser octree has these properties.
/// Cost: one parallel pass over flags for each level; nothing ripples.
[[nodiscard]] CellFlags mergeCells(const ClusterForest& forest, const CutRule& rule,
                                   const CellFlags& forbidden, base::Job& job);

/// The surface cells that are leaves, by level.
[[nodiscard]] std::vector<LeafCell> collectLeaves(const ClusterForest& forest,
                                                  const uniform::CellTopology& topology,
                                                  const CellFlags& merged);

}  // namespace tufa::octree
