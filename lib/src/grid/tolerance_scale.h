#pragma once

#include <tufa/openvdb_fwd.h>

#include <functional>
#include <memory>

#include "grid/transform.h"

namespace tufa::grid {

/// What multiplies the tolerance at a lattice point of the meshed grid, whose transform is given:
/// the nearest value of a float grid; 0 where that is negative or no number, the largest float
/// where it is infinite. Throws Error(UnsupportedGrid) for grids of other types.
[[nodiscard]] std::function<double(const Vec3&)> toleranceScale(
    const std::shared_ptr<const openvdb::GridBase>& scales, const Transform& transform);

}  // namespace tufa::grid
