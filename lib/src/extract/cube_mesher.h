#pragma once

#include <tufa/contour.h>

#include "base/job.h"
#include "extract/cube_cells.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// Meshes the cells of a volume by their cases: a vertex on each crossed lattice edge, placed as
/// the crossings of dual contouring are, and for some cases some inside the cell. Positions are
/// counted from the volume's affine.origin(). Sets what `report` says of cells.
[[nodiscard]] Mesh meshCubes(const grid::Volume& volume, const CubeRule& rule,
                             const ContourOptions& options, ContourReport& report, base::Job& job);

/// Writes the vertex inside a cell that is the mean of the crossings of the edges whose bits are
/// set; its normal, if the mesh has some, is theirs.
void placeCentre(unsigned around, int place, const CubeTable& table, VertexIndex centre,
                 Mesh& mesh);

}  // namespace tufa::extraction
