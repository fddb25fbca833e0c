#pragma once

#include <tufa/contour.h>

#include <vector>

#include "intersect/surface.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// repairIntersections() of a uniform mesh as it will be written: in world space, and in single
/// precision where that moves nothing far. What is not moved keeps its position; nothing becomes a
/// fan. `closePairs` must hold every pair that intersects then. Cost: a pass over the positions,
/// and copies of the blocks of polygons that intersect and of the blocks around these.
void repairRounded(uniform::UniformSurface& surface,
                   const std::vector<intersect::PolygonPair>& closePairs, ContourReport& report,
                   base::Job& job);

}  // namespace tufa::refine
