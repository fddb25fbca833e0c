#pragma once

#include <vector>

#include "certify/certificate.h"
#include "cut/cut.h"
#include "cut/leaves.h"
#include "forest/forest.h"

namespace tufa::certify {

/// Forbids the cells above `minLevel` of some vertices of a cut. Returns whether there are any, so
/// that the next cut will be finer.
bool splitCells(const std::vector<VertexIndex>& vertices, const cut::Cut& cut, int minLevel,
                cut::CellFlags& forbidden);

/// The vertices whose cells must be split for the tolerance: those of the polygons that are too
/// far, and those that stand for points of the base mesh that are.
[[nodiscard]] std::vector<VertexIndex> tooCoarse(const Mesh& base, const cut::Cut& cut,
                                                 const Deviation& deviation);

}  // namespace tufa::certify
