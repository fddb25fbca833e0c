#pragma once

#include <vector>

#include "base/job.h"
#include "extract/block_triangles.h"
#include "extract/cell_features.h"
#include "extract/cube_cells.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// When cells are merged into leaves of an octree.
struct MergeRule {
  double tolerance = 0;    ///< in voxels
  double leastCosine = 0;  ///< of the angle between a normal and that of the leaf's plane
};

/// Merges cells into leaves of 2, 4 or 8 cells along an edge, takes their cases away, and returns
/// the triangles of the leaves, by blocks. `crossings` holds a vertex for each edge of `cells`,
/// from which the blocks count their own; `features` tells which loops of cells have a vertex.
///
/// Leaves keep the topology of the finest faces. Of the surface in a leaf what remains is its
/// boundary: the arcs between it and other leaves. Where two leaves meet in a square, the arcs in
/// it are chains that end at its sides; each is replaced by the straight segment between its ends.
/// So a crossing stays where three leaves meet or four, and both leaves at a square see the same
/// segments, whatever their levels: there are no cracks. The loops that segments form on a leaf
/// are filled inside it, by chords that lie in no face of it or by a fan around their middle.
///
/// All crossed lattice edges of a leaf along one axis lead the same way, out of the inside or into
/// it. So no component lies in a leaf alone and would be lost, no chain is closed in its square,
/// and no edge of a leaf is crossed twice. Hence a chain ends at two different sides of its square,
/// no two chains of one mesh have both ends in common, a loop has three corners or more, and no
/// edge has more than two triangles: the mesh is closed and a 2-manifold on any field.
///
/// All crossings of a leaf lie between two planes that are the tolerance apart, and so do its
/// triangles and the finest ones that they stand for. A cell with a feature is not merged, nor are
/// cells of blocks in which or beside which the data ends.
[[nodiscard]] std::vector<BlockTriangles> mergeCells(const grid::Volume& volume, CubeCells& cells,
                                                     const std::vector<CellFeatures>& features,
                                                     const Mesh& crossings, const MergeRule& rule,
                                                     base::Job& job);

}  // namespace tufa::extraction
