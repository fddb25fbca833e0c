#pragma once

#include <tufa/contour.h>

#include "base/job.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// Cubical marching squares (Ho, Wu, Chen, Chuang and Ouhyoung, "Cubical marching squares: adaptive
/// feature preserving surface extraction from volume data", 2005): the contours of the faces of
/// cells first, with a sharp point where the tangent lines of an arc meet whose normals differ by
/// more than `sharpAngle` degrees; then the loops that arcs form in each cell. A loop whose normals
/// differ by as much is filled by a fan around the best point for its tangent planes, others as
/// marching cubes do.
///
/// An ambiguous face is joined in the way in which its two arcs do not intersect, or else as its
/// saddle is. Both cells at a face have its arcs and points in common, so there are no cracks; and
/// an arc with a sharp point is of fans alone, so that no edge but the arcs' is in a face: the mesh
/// is a 2-manifold.
///
/// With a `tolerance`, in voxels, cells without a crease are merged into leaves of an octree, see
/// mergeCells(); 0: all cells are the finest.
///
/// Departures: leaves take the contours of their faces from the finest cells, not only where their
/// neighbours are finer, and have no creases in them; each loop is a disk, where the paper
/// may join two in a tunnel; and in distance fields vertices are those of findSharpLoops(), and an
/// arc's point is where their crease passes the face, or, if it passes beside the face, half way
/// between the vertices of the two loops.
[[nodiscard]] Mesh meshSquares(const grid::Volume& volume, double sharpAngle, double tolerance,
                               const ContourOptions& options, ContourReport& report,
                               base::Job& job);

}  // namespace tufa::extraction
