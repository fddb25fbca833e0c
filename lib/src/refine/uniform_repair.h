#pragma once

#include <tufa/contour.h>

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "refine/repair/repair.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// What the repair asks of a uniform surface, of its own elements and in its own positions. Keeps
/// references to both arguments.
[[nodiscard]] Source sourceOf(const uniform::UniformSurface& surface, base::Job& job);

/// Takes the self-intersections out of a uniform mesh, as far as that can be done without further
/// vertices, and returns quads of which each pair that still meets, even after rounding, has one;
/// sorted. Adds to the counts of the repair in `report`.
[[nodiscard]] std::vector<std::uint32_t> repairUniform(uniform::UniformSurface& surface,
                                                       ContourReport& report, base::Job& job);

}  // namespace tufa::refine
