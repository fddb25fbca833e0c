#pragma once

#include <vector>

#include "base/job.h"
#include "chunks/chain/chunk_chain.h"
#include "grid/transform.h"

namespace tufa::chunks {

/// The step of a lattice in world space on which 16 bits name all places inside a chunk: times
/// `scale` it is a power of two, so that programs that compute in floats lose nothing.
[[nodiscard]] double latticeStep(const grid::Transform& transform, int chunkSize, double scale);

/// Moves all vertices to the lattice. Changes nothing and returns false if that brought two
/// vertices of an LOD to one place, or a triangle of either form that has an area would have none.
[[nodiscard]] bool moveToLattice(std::vector<ChainLevel>& levels, double step, base::Job& job);

}  // namespace tufa::chunks
