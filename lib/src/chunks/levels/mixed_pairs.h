#pragma once

#include <vector>

#include "base/job.h"
#include "chunks/levels/seamed_cut.h"
#include "chunks/seams/seams.h"
#include "grid/affine.h"
#include "intersect/surface.h"

namespace tufa::chunks {

/// Finds strips that intersect although neither mesh of an LOD has both: two of one chunk, one to
/// its own polyline on a face, the other to that of the next LOD on another face, as a mask may
/// combine them. Of each pair `a` is a polygon of `regular`, `b` one of `transition`; the two
/// meshes share all but polylines and strips. `seamPositions` are the seams' vertices in the world;
/// `affine` takes the others there.
[[nodiscard]] std::vector<intersect::PolygonPair> findMixedPairs(
    const SeamedCut& regular, const SeamedCut& transition, const Seams& seams,
    const std::vector<Position>& seamPositions, const grid::Affine& affine, bool singlePrecision,
    base::Job& job);

}  // namespace tufa::chunks
