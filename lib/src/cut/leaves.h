#pragma once

#include <tufa/octree.h>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "components/topology.h"
#include "cut/cut_rule.h"
#include "forest/forest.h"

namespace tufa::cut {

/// One bit for each cell of a forest, by level; bit and cell order as in forest::BlockForest.
struct CellFlags {
  std::vector<std::uint64_t> level1;              ///< for each surface block
  std::vector<std::uint8_t> level2;               ///< for each surface block
  std::vector<std::vector<std::uint8_t>> levels;  ///< as forest::Forest::levels

  explicit CellFlags(const forest::Forest& forest);
};

/// The cells that a cut merges: the leaves of a restricted octree, and all cells below them. A cell
/// is merged if it is safe, keeps the rule, is not forbidden, its children are merged, and so are
/// all surface cells of its children's size that touch it: no two leaves that touch differ by more
/// than one level, and no coarser octree has these properties.
[[nodiscard]] CellFlags mergeCells(const forest::Forest& forest,
                                   const components::Topology& topology, const CutRule& rule,
                                   const CellFlags& forbidden, base::Job& job);

/// The surface cells that are leaves, by level.
[[nodiscard]] std::vector<LeafCell> collectLeaves(const forest::Forest& forest,
                                                  const components::Topology& topology,
                                                  const CellFlags& merged);

}  // namespace tufa::cut
