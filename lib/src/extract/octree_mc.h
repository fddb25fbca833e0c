#pragma once

#include <tufa/contour.h>

#include "base/job.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// Marching cubes on the dual grid of an octree (Schaefer and Warren, "Dual marching cubes: primal
/// contouring of dual grids", 2004): its vertices are the centres of leaves, its cells lie around
/// the corners of leaves. A dual cell is a cube of eight samples, several of which may be in one
/// leaf: a collapsed hexahedron, whose triangles with two corners alike are left out. Both cells at
/// a dual face see the same four leaves, so there are no cracks, and no leaf needs to know the
/// levels of those beside it.
///
/// The octree has a sample at the centre of each of its finest leaves, and leaves of up to 8
/// samples along an edge where the field is affine to `options.tolerance`; see mergeSamples(). In
/// place of one vertex a feature as in the paper, dual vertices stay at the centres of leaves.
[[nodiscard]] Mesh meshOctree(const grid::Volume& volume, const ContourOptions& options,
                              ContourReport& report, base::Job& job);

}  // namespace tufa::extraction
