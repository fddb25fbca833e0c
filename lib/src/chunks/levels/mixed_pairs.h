#pragma once

#include <vector>

#include "base/job.h"
#include "chunks/levels/seamed_cut.h"
#include "chunks/seams/seams.h"
#include "grid/affine.h"
#include "intersect/surface.h"

namespace tufa::chunks {

/// Finds strips that meet although neither mesh of a level has both: of one chunk, one with the
/// lines of its own level on a face, one with those of the next level on another face. Of each pair
/// `a` is a polygon of `regular`, `b` one of `transition`; the two share all but lines and strips.
/// `seamPositions` are those of the seams' vertices in the world; `affine` takes the others there.
[[nodiscard]] std::vector<intersect::PolygonPair> findMixedPairs(
    const SeamedCut& regular, const SeamedCut& transition, const Seams& seams,
    const std::vector<Position>& seamPositions, const grid::Affine& affine, bool singlePrecision,
    base::Job& job);

}  // namespace tufa::chunks
