#pragma once

#include "base/job.h"
#include "octree/cluster_forest.h"
#include "uniform/surface_view.h"

namespace tufa::octree {

/// Builds the levels from the uniform mesh up, until none has a safe cell or cells have 2^maxLevel
/// voxels along their edge; levels 1 to 3 always. `angles`: gather the angles between normals too;
/// else they are 0. The result is the same for any number of threads. Cost: proportional to the
/// number of surface cells.
[[nodiscard]] ClusterForest buildForest(const uniform::SurfaceView& base, int maxLevel, bool angles,
                                        base::Job& job);

}  // namespace tufa::octree
