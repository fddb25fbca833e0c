#pragma once

#include <tufa/octree.h>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "octree/cluster_forest.h"
#include "octree/cut_rule.h"
#include "uniform/cell_topology.h"

namespace tufa::octree {

/// One bit for each cell of a forest, by level; bit and cell order as in BlockForest.
struct CellFlags {
  std::vector<std::uint64_t> level1;              ///< for each surface block
  std::vector<std::uint8_t> level2;               ///< for each surface block
  std::vector<std::vector<std::uint8_t>> levels;  ///< as Forest::levels

  explicit CellFlags(const Forest& forest);
};

/// The cells that a cut merges: the leaves of a restricted octree, and all cells below them. A cell
/// is merged if it is safe, keeps the rule, is not forbidden, its children are merged, and so are
/// all surface cells of its children's size that touch it: no two leaves that touch differ by more
/// than one level, and no coarser octree has these properties.
[[nodiscard]] CellFlags mergeCells(const Forest& forest, const uniform::Topology& topology,
                                   const CutRule& rule, const CellFlags& forbidden, base::Job& job);

/// The surface cells that are leaves, by level.
[[nodiscard]] std::vector<LeafCell> collectLeaves(const Forest& forest,
                                                  const uniform::Topology& topology,
                                                  const CellFlags& merged);

}  // namespace tufa::octree
