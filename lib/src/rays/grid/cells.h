#pragma once

#include <tufa/openvdb_fwd.h>
#include <tufa/rays.h>

#include <memory>

#include "base/job.h"

namespace tufa::rays {

/// The cells that the surface of a grid passes, for rays: of any float or double grid with a linear
/// transform. Throws Error as contour() does.
[[nodiscard]] std::shared_ptr<const RaySurface> makeCellSurface(
    std::shared_ptr<const openvdb::GridBase> grid, const RaySurfaceOptions& options,
    base::Job& job);

/// The same by OpenVDB's LevelSetRayIntersector, for a level set with cubes for voxels, a band of
/// two voxels to each side and its isovalue 0, whose values must be finite; null for other grids.
[[nodiscard]] std::shared_ptr<const RaySurface> makeLevelSetSurface(
    const std::shared_ptr<const openvdb::GridBase>& grid, const RaySurfaceOptions& options);

}  // namespace tufa::rays
