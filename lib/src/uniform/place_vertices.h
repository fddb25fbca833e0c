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

/// Where vertices may go if their places are not accepted: points in their cells, counted from
/// affine.origin() like the positions of the mesh.
struct FallbackPoints {
  std::vector<Position> plain;  ///< the point of a vertex's QEF alone, without regard to creases
  std::vector<Position> mass;   ///< the mean of its crossings
};

/// The fallbacks of some vertices, given in rising order. Cost: the crossings of their blocks.
[[nodiscard]] FallbackPoints fallbackPoints(
    const grid::Blocks& blocks, const grid::FieldScale& scale, const CellTopology& topology,
    const grid::Affine& affine, const std::vector<VertexIndex>& vertices, base::Job& job);

/// Gives each vertex the mean of the normals of its faces, weighted by their angles at the vertex.
void setFaceNormals(Mesh& mesh, base::Job& job);

}  // namespace tufa::uniform
