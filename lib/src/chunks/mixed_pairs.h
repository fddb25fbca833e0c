#pragma once

#include <vector>

#include "base/affine.h"
#include "base/job.h"
#include "chunks/seamed_cut.h"
#include "chunks/seams.h"
#include "mend/surface.h"

namespace tufa::chunks {

/// Finds strips that meet although neither mesh of a level has both: of one chunk, one with the
/// lines of its own level on a face, one with those of the next level on another face. Of each pair
/// `a` is a polygon of `regular`, `b` one of `transition`; the two share all but lines and strips.
/// `seamPositions` are those of the seams' vertices in the world; `affine` takes the others there.
[[nodiscard]] std::vector<mend::PolygonPair> findMixedPairs(
    const SeamedCut& regular, const SeamedCut& transition, const Seams& seams,
    const std::vector<Position>& seamPositions, const base::Affine& affine, bool singlePrecision,
    base::Job& job);

}  // namespace tufa::chunks
