#pragma once

#include "chunks/seams/seams.h"
#include "grid/affine.h"

namespace tufa::chunks {

/// Sets Arc::clearance of all arcs. What is looked at lies on their own faces.
void measureClearance(const grid::Affine& affine, Seams& seams);

}  // namespace tufa::chunks
