#pragma once

#include <cstdint>
#include <vector>

#include "refine/collapse/collapse.h"
#include "refine/collapse/edge_mesh.h"
#include "refine/collapse/sample_lists.h"

namespace tufa::refine {

/// Turns the longest edge of flat triangles where that makes both triangles at it rounder, and
/// neither the topology, nor a direction, nor what is near a sample suffers. Looks at triangles as
/// they lie in the mesh, a few times over.
///
/// `allowed` tells for each vertex how far the surface may move there, 0: not at all. Returns a
/// mark for each triangle, 1 if it was turned.
[[nodiscard]] std::vector<std::uint8_t> flipSlivers(EdgeMesh& mesh, const Bounds& bounds,
                                                    const std::vector<double>& budget,
                                                    SampleLists samples);

}  // namespace tufa::refine
