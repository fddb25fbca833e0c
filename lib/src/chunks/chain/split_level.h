#pragma once

#include <tufa/chunks.h>
#include <vector>

#include "base/job.h"
#include "chunks/chain/chunk_chain.h"
#include "chunks/chain/shaded_level.h"
#include "chunks/cut/cut_mesh.h"

namespace tufa::chunks {

/// Divides an LOD of the whole surface into those of its chunks, one for each of `cut.chunks`.
/// Triangles that change beside the next level are strips, all others are the interior's.
[[nodiscard]] std::vector<ChunkLevel> splitLevel(const CutMesh& cut, const ChainLevel& level,
                                                 const ShadedLevel& shaded, base::Job& job);

}  // namespace tufa::chunks
