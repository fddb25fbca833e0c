#pragma once

#include "octree/cluster_forest.h"
#include "octree/patch.h"

namespace tufa::octree {

/// A level and the patches of its clusters, one for one.
struct LevelPatches {
  Level level;
  std::vector<Patch> patches;  ///< planes seen from the lower corner of the cell
};

/// The level above: its cells, and the clusters of those that may become leaves. Fills in the
/// parents of the clusters and cells below.
[[nodiscard]] LevelPatches buildLevelAbove(LevelPatches& below, const grid::Affine& affine,
                                           base::Job& job);

}  // namespace tufa::octree
