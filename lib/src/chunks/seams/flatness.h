#pragma once

#include <tufa/mesh.h>

#include "chunks/seams/seams.h"
#include "grid/affine.h"

namespace tufa::chunks {

/// Sets Arc::flatness of all arcs, from vertices within a few cells of their faces. `before` has
/// the positions of `base` before its repair.
void measureFlatness(const Mesh& base, const Mesh& before, const grid::Affine& affine,
                     Seams& seams);

}  // namespace tufa::chunks
