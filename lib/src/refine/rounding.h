#pragma once

#include <tufa/mesh.h>

#include <vector>

#include "base/job.h"
#include "grid/volume.h"

namespace tufa::refine {

/// The farthest that the rounding of world positions to single precision may move them, in voxels.
inline constexpr double kMostRounding = 5e-4;

/// The farthest that rounding to single precision can move a point near the surface of a volume, or
/// of the volume that it is a part of, in world units: by its largest coordinate.
[[nodiscard]] double largestRounding(const grid::Volume& volume);

/// The margin for searches of intersections whose result is to hold once the mesh is rounded:
/// rounding may move both polygons of a pair. Flat faces on lattice planes lie a thousandth of a
/// voxel off their samples, so a larger margin than is needed would make all their polygons
/// candidates.
[[nodiscard]] double roundingMargin(const grid::Volume& volume);

/// Whether takeToWorld() rounds a mesh with these positions.
[[nodiscard]] bool isWrittenInSingle(const std::vector<Position>& positions,
                                     const grid::Affine& affine, base::Job& job);

/// Takes a mesh to world space as it will be written: in single precision if that moves nothing
/// farther than kMostRounding. Whether it does.
bool takeToWorld(Mesh& mesh, const grid::Affine& affine, base::Job& job);

}  // namespace tufa::refine
