#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "chunks/cut/cut_mesh.h"

namespace tufa::chunks {

/// Where a coordinate lies among the planes across an axis: 2n on plane n, 2n + 1 between planes n
/// and n + 1. Planes are eight voxels apart or more, so that a number of them has 29 bits.
using Place = std::int32_t;
using PlacesAmongPlanes = std::array<Place, 3>;

/// Numbers the planes that vertices lie on with chunks on both sides, and sets CutMesh::planes and
/// planesOf: a flat face in a plane is all on one side of it. `places`: of each vertex. Triangles
/// must have their chunks.
void namePlanes(const std::vector<PlacesAmongPlanes>& places, CutMesh& cut);

}  // namespace tufa::chunks
