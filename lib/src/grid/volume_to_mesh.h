#pragma once

#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>

#include "grid/isovalue.h"

namespace tufa::grid {

/// The mesh of OpenVDB's own mesher, openvdb::tools::volumeToMesh(), in world space, to compare
/// with: on all threads of the arena. Its faces are turned so that what is inside by `iso` is
/// behind them. For float and double grids.
[[nodiscard]] Mesh volumeToMesh(const openvdb::GridBase& grid, const IsoChoice& iso,
                                double adaptivity);

}  // namespace tufa::grid
