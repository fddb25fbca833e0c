#pragma once

#include <tufa/contour.h>

#include <vector>

#include "base/job.h"
#include "refine/repair/repair.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// The source for repairs of a uniform surface, for its own elements and in its own positions.
/// Keeps references to both arguments.
[[nodiscard]] Source sourceOf(const uniform::UniformSurface& surface, base::Job& job);

/// Removes self-intersections of a uniform mesh, as far as no additional vertices are needed, and
/// returns the pairs of quads that remain close: all that still intersect, even after rounding, are
/// among them; sorted. Adds to the counts of the repair in `report`.
[[nodiscard]] std::vector<intersect::PolygonPair> repairUniform(uniform::UniformSurface& surface,
                                                                ContourReport& report,
                                                                base::Job& job);

}  // namespace tufa::refine
