#pragma once

#include <cstddef>
#include <vector>

#include "base/job.h"
#include "grid/blocks.h"
#include "grid/slab.h"

namespace tufa::chunks {

/// Divides a grid across its longest axis into slabs of whole chunks, of about as many active
/// voxels each, `voxels` or more, and `thickness` voxels thick or more. First and last are indices
/// of chunks. Slabs meet: one that follows begins where the one before ends. Depends on the grid
/// alone.
[[nodiscard]] std::vector<grid::Slab> splitIntoSlabs(const grid::Blocks& blocks, int chunkSize,
                                                     std::size_t voxels, int thickness,
                                                     base::Job& job);

/// The samples of a slab of chunks, and so many voxels more on both sides, as far as there is a
/// slab beside it.
[[nodiscard]] grid::Slab samplesOf(const grid::Slab& slab, const std::vector<grid::Slab>& all,
                                   int chunkSize, int margin);

}  // namespace tufa::chunks
