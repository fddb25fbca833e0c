#pragma once

#include <tufa/mesh.h>

#include "base/job.h"

namespace tufa::implicit {

/// A mesh with its triangles alone, each position once, that is closed as neighboursIn() wants it.
/// Throws Error(InvalidArgument) where there is none.
[[nodiscard]] Mesh closedMesh(const Mesh& mesh);

/// Whether two faces intersect, or touch beyond the corners that they share.
[[nodiscard]] bool intersectsItself(const Mesh& mesh, base::Job& job);

/// Throws Error(InvalidArgument) for meshes that are not closed, of which parts face inward or
/// outward where they are no boundary so (see Shells), and for those that intersect themselves:
/// the normal at the face nearest to a point does not tell its side there.
void requireSolid(const Mesh& mesh, base::Job& job);

}  // namespace tufa::implicit
