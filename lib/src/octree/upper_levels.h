#pragma once

#include <vector>

#include "base/job.h"
#include "grid/affine.h"
#include "octree/cluster_forest.h"
#include "octree/patch.h"

namespace tufa::octree {

/// The level above one whose cells are blocks or larger: its cells, and the clusters of those that
/// may become leaves. Fills in the parents of the clusters and cells below. `patches`, those of the
/// clusters below, are replaced by those of the new clusters. Coordinates of their planes count
/// from the lower corner of their cell.
[[nodiscard]] ClusterLevel buildLevelAbove(ClusterLevel& below, std::vector<Patch>& patches,
                                           const grid::Affine& affine, base::Job& job);

}  // namespace tufa::octree
