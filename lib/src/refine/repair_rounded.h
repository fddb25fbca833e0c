#pragma once

#include "grid/affine.h"
#include "refine/repair/repair.h"

namespace tufa::refine {

/// repairIntersections() of a mesh as it will be written: in world space, and in single precision
/// where that moves nothing far. What is not moved keeps its position; nothing becomes a fan.
/// `closePairs` must hold every pair that intersects then.
RepairReport repairRounded(Mesh& mesh, const std::vector<intersect::PolygonPair>& closePairs,
                           Source source, const grid::Affine& affine, base::Job& job);

}  // namespace tufa::refine
