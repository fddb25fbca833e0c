#pragma once

#include "base/job.h"
#include "chunks/cut/cut_mesh.h"
#include "grid/affine.h"

namespace tufa::chunks {

/// Separates triangles of a cut mesh that nearly touch, so that they do not intersect once
/// positions are rounded as they will be written, to single precision in world space if
/// `singlePrecision`. Moves vertices that are on no plane a little, and keeps all positions as they
/// were before as `reference` if there are any. Looks at triangles that have a new vertex: those of
/// the uniform mesh do not intersect each other.
void separateRounded(CutMesh& cut, const grid::Affine& affine, bool singlePrecision,
                     base::Job& job);

/// refine::keepApart(): no two vertices of a level have the same place, by which chunks are joined,
/// unless a collapse brings them together.
void keepApart(CutMesh& cut, const grid::Affine& affine, bool singlePrecision, base::Job& job);

}  // namespace tufa::chunks
