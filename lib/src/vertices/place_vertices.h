#pragma once

#include <tufa/mesh.h>
#include <cstddef>
#include <vector>

#include "base/affine.h"
#include "base/job.h"
#include "blocks/blocks.h"
#include "blocks/field.h"
#include "components/topology.h"
#include "creases/vertex_sides.h"

namespace tufa::vertices {

/// Sizes and fills the positions of the mesh and, if asked, its normals from the field's gradient.
/// Returns which vertices lie near or on creases.
template <class TreeT>
[[nodiscard]] creases::VertexSides placeVertices(const blocks::Blocks<TreeT>& blocks,
                                                 const blocks::FieldScale& scale,
                                                 const components::Topology& topology,
                                                 const base::Affine& affine, bool normals,
                                                 Mesh& mesh, base::Job& job);

/// The mean of the crossings of each of some vertices, sorted, in world space: a point inside the
/// vertex's cell.
template <class TreeT>
[[nodiscard]] std::vector<Position> massPoints(const blocks::Blocks<TreeT>& blocks,
                                               const blocks::FieldScale& scale,
                                               const components::Topology& topology,
                                               const base::Affine& affine,
                                               const std::vector<VertexIndex>& vertices,
                                               base::Job& job);

/// Gives each vertex the mean of the normals of its faces, weighted by their angles at the vertex.
void setFaceNormals(Mesh& mesh, base::Job& job);

}  // namespace tufa::vertices
