#pragma once

#include <cstdint>
#include <vector>

#include "refine/collapse/collapse.h"
#include "refine/collapse/edge_mesh.h"
#include "refine/collapse/sample_lists.h"

namespace tufa::refine {

/// Flips the longest edge of slivers if that makes the worse of the two triangles at it rounder,
/// turns neither over, sharpens no fold, and keeps all samples and the middle of the new edge
/// within `budget`, world length for each vertex. Takes the triangles in the order of the mesh, a
/// few times over, on one thread. Returns a mark for each triangle, 1 if it was flipped.
[[nodiscard]] std::vector<std::uint8_t> flipSlivers(EdgeMesh& mesh, const Bounds& bounds,
                                                    const std::vector<double>& budget,
                                                    SampleLists samples);

}  // namespace tufa::refine
