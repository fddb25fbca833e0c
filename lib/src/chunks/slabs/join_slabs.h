#pragma once

#include <vector>

#include "base/job.h"
#include "chunks/slabs/cut_slab.h"

namespace tufa::chunks {

/// Makes one mesh of slabs, the lowest first, each of which fits the one before; see fit(). Each
/// has CutMesh::errors. Throws Error(LimitExceeded) if that has more vertices than 32-bit indices
/// can name.
[[nodiscard]] CutMesh joinSlabs(std::vector<CutSlab> slabs, base::Job& job);

}  // namespace tufa::chunks
