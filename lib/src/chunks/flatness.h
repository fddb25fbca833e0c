#pragma once

#include <tufa/mesh.h>

#include "base/affine.h"
#include "chunks/seams.h"

namespace tufa::chunks {

/// Sets Arc::flatness of all arcs. What is looked at lies within a few cells of their faces.
/// `before` has the positions of `base` before its repair.
void measureFlatness(const Mesh& base, const Mesh& before, const base::Affine& affine,
                     Seams& seams);

}  // namespace tufa::chunks
