#pragma once

#include <tufa/contour.h>
#include <tufa/mesh.h>

#include "base/job.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// What to refine to, and which vertices to leave alone.
struct RefineRule {
  double tolerance = 0;  ///< voxels
  /// Vertices farther from the surface stay, as do the edges at them: they are on creases, which
  /// the trilinear surface rounds off. Others are moved onto it first. Voxels.
  double stayBeyond = 0;
};

/// Splits triangles where the middle of an edge, or their own, is farther than the tolerance from
/// the trilinear surface, and puts the new vertices on it: along the gradient, by bisection.
///
/// Edges are split for all their triangles at once, so that a mesh without cracks has none at any
/// step, and its topology stays. With an edge, the longest edge of each triangle around it is split
/// (Rivara, "Algorithms for refining triangular grids suitable for adaptive and multigrid
/// techniques", 1984), so that angles do not get ever smaller.
///
/// Ends when the tolerance holds, or where edges are shorter than an eighth of a voxel, whose
/// halves would be the finest. Vertices go at most 60 degrees beside the mesh's normal, by half of
/// their shortest edge, and new ones by a quarter of their edge, so that they find no other sheet
/// and edges get shorter; others stay where they are, as do those whose move would turn a triangle
/// by more than 60 degrees or fold the mesh over at an edge. Positions are counted from the
/// volume's affine.origin(); quads become triangles. Returns what was reached.
Refinement refineTriangles(const grid::Volume& volume, const RefineRule& rule, Mesh& mesh,
                           base::Job& job);

}  // namespace tufa::extraction
