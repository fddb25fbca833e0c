#pragma once

#include <cstddef>
#include <tufa/mesh.h>

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

/// Gives each vertex the mean of the normals of its faces, weighted by their angles at the vertex.
void setFaceNormals(Mesh& mesh, base::Job& job);

}  // namespace tufa::vertices
