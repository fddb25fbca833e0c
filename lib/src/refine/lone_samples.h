#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "refine/repair/repair.h"

namespace tufa::refine {

/// Unfolds components around single samples, of eight vertices and six quads, that a weak field has
/// folded flat or turned inside out: their vertices go to their mass points, the corners of a box
/// around the sample. Returns how many vertices moved.
std::size_t unfoldLoneComponents(Mesh& mesh, const Source& source, base::Job& job);

}  // namespace tufa::refine
