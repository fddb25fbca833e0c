#pragma once

#include <tufa/mesh.h>

#include "base/job.h"

namespace tufa::implicit {

/// A mesh with its triangles alone, each position once, that is closed as neighboursIn() wants it.
/// Throws Error(InvalidArgument) where there is none.
[[nodiscard]] Mesh closedMesh(const Mesh& mesh);

/// Whether two faces intersect, or touch beyond the corners that they share.
[[nodiscard]] bool intersectsItself(const Mesh& mesh, base::Job& job);

/// Throws Error(InvalidArgument) unless a mesh is closed, each of its parts faces outward or is a
/// cavity (see Shells), and no faces intersect or touch. Only then does the normal at the nearest
/// face tell on which side of the mesh a point is.
void requireSolid(const Mesh& mesh, base::Job& job);

}  // namespace tufa::implicit
