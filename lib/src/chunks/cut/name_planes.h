#pragma once

#include <vector>

#include "base/job.h"
#include "chunks/cut/chunk_planes.h"
#include "chunks/cut/cut_mesh.h"

namespace tufa::chunks {

/// Numbers the planes that vertices lie on with chunks on both sides, and sets CutMesh::planes,
/// onPlanes and planesOf: a flat face in a plane is all on one side of it. `places`: of each
/// vertex. Triangles must have their chunks.
void namePlanes(const std::vector<PlacesAmongPlanes>& places, CutMesh& cut, base::Job& job);

}  // namespace tufa::chunks
