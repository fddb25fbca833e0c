#pragma once

#include "base/affine.h"
#include "chunks/seams.h"

namespace tufa::chunks {

/// Sets Arc::clearance of all arcs. What is looked at lies on their own faces.
void measureClearance(const base::Affine& affine, Seams& seams);

}  // namespace tufa::chunks
