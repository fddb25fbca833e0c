#pragma once

#include "chunks/seams/seams.h"
#include "grid/affine.h"

namespace tufa::chunks {

/// Sets Arc::clearance of all arcs, from arcs on their own faces alone.
void measureClearance(const grid::Affine& affine, Seams& seams);

}  // namespace tufa::chunks
