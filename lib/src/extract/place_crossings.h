#pragma once

#include <tufa/mesh.h>

#include <vector>

#include "base/job.h"
#include "extract/cube_cells.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// Writes the position of each crossed lattice edge and, if there is room for them, its normal.
/// They are the crossings that dual contouring gathers, see uniform::CrossingFinder. Positions are
/// counted from the volume's affine.origin().
void placeCrossings(const grid::Volume& volume, const uniform::CellTopology& topology,
                    const std::vector<BlockEdges<3>>& edges, Mesh& mesh, base::Job& job);

/// A mesh of the crossings of all edges, with normals.
[[nodiscard]] Mesh meshOfCrossings(const grid::Volume& volume, const CubeCells& cells,
                                   base::Job& job);

/// Takes away the vertices that no triangle has, and keeps the order of the others.
void dropUnused(Mesh& mesh, base::Job& job);

}  // namespace tufa::extraction
