#pragma once

#include <tufa/contour.h>

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "refine/repair/repair.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// The source for repairs of a uniform surface, for its own elements and in its own positions.
/// Keeps references to both arguments.
[[nodiscard]] Source sourceOf(const uniform::UniformSurface& surface, base::Job& job);

/// Removes self-intersections of a uniform mesh, as far as no additional vertices are needed, and
/// returns the candidates that remain: each pair of quads that still intersects, even after
/// rounding, contains one; sorted. Adds to the counts of the repair in `report`.
[[nodiscard]] std::vector<std::uint32_t> repairUniform(uniform::UniformSurface& surface,
                                                       ContourReport& report, base::Job& job);

}  // namespace tufa::refine
