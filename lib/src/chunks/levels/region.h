#pragma once

#include <tufa/chunks.h>
#include <vector>

#include "base/job.h"
#include "chunks/levels/split_chunks.h"
#include "chunks/seams/chunk_cells.h"
#include "octree/cut_rule.h"
#include "refine/surface_model.h"

namespace tufa::chunks {

/// How the chunks of a region are made. A region is a box of chunks that are built together.
struct RegionOptions {
  octree::CutRule rule;            ///< but for its tolerance
  std::vector<double> tolerances;  ///< of the LODs, voxels
  bool repair = true;              ///< split cells until no two polygons intersect
  bool simplify = true;            ///< collapse edges inside the chunks
  bool singlePrecision = false;    ///< positions are rounded to floats
};

/// Makes the chunks of a region that the surface passes, in the order of their indices. `model`
/// must hold all blocks of these chunks and those that touch them.
///
/// Each LOD is a cut of the region's forest in which every chunk is a cut of its own. It is
/// repaired and measured with its own boundary polylines and with those of the next LOD; where it
/// is at fault, cells are split. Chunks of neighbouring regions fit: what both share, vertices and
/// polylines on seams, depends on what is near the face alone.
[[nodiscard]] std::vector<MadeChunk> makeRegion(const refine::SurfaceModel& model,
                                                const ChunkCells& chunks,
                                                const RegionOptions& options, base::Job& job);

}  // namespace tufa::chunks
