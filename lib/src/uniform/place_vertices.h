#pragma once

#include <tufa/mesh.h>
#include <cstddef>
#include <vector>

#include "base/job.h"
#include "grid/affine.h"
#include "grid/blocks.h"
#include "grid/field.h"
#include "uniform/cell_topology.h"
#include "uniform/vertex_sheets.h"

namespace tufa::uniform {

/// Sizes and fills the positions of the mesh and, if `normals`, its normals from the field's
/// gradient. Returns which vertices lie near or on creases.
[[nodiscard]] VertexSheets placeVertices(const grid::Blocks& blocks, const grid::FieldScale& scale,
                                         const CellTopology& topology, const grid::Affine& affine,
                                         bool normals, Mesh& mesh, base::Job& job);

/// Where a vertex may go if its place is not accepted. Both points lie in its cell.
enum class Fallback {
  Plain,      ///< the point of its QEF alone, without regard to creases
  MassPoint,  ///< the mean of its crossings
};

/// The fallback of each of some vertices, given in rising order. Counted from affine.origin(), like
/// the positions of the mesh.
[[nodiscard]] std::vector<Position> fallbackPoints(Fallback which, const grid::Blocks& blocks,
                                                   const grid::FieldScale& scale,
                                                   const CellTopology& topology,
                                                   const grid::Affine& affine,
                                                   const std::vector<VertexIndex>& vertices,
                                                   base::Job& job);

/// Gives each vertex the mean of the normals of its faces, weighted by their angles at the vertex.
void setFaceNormals(Mesh& mesh, base::Job& job);

}  // namespace tufa::uniform
