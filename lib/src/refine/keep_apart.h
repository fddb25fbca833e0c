#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "base/job.h"
#include "grid/affine.h"

namespace tufa::refine {

/// Gives vertices that would be at the place of another one in world space, once positions are
/// rounded as they will be written, to single precision if `singlePrecision`, a place of their own,
/// the next free one along x: what joins vertices by positions would make one of those of sheets
/// that touch. Vertices without triangles do not count. Positions are the grid's. Returns how far a
/// vertex has moved at most, voxels.
[[nodiscard]] double keepApart(std::vector<Position>& positions,
                               const std::vector<Triangle>& triangles, const grid::Affine& affine,
                               bool singlePrecision, base::Job& job);

}  // namespace tufa::refine
