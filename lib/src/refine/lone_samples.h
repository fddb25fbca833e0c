#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "refine/repair/repair.h"

namespace tufa::refine {

/// Turns the right way out the pieces around single samples, of eight vertices and six quads, that
/// a weak field has folded flat or through themselves: their vertices go to their mass points,
/// which are the corners of a box around the sample. Returns how many vertices moved.
std::size_t unfoldLoneComponents(Mesh& mesh, const Source& source, base::Job& job);

}  // namespace tufa::refine
