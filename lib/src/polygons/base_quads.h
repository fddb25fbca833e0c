#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "base/affine.h"
#include "base/job.h"
#include "blocks/blocks.h"
#include "components/topology.h"
#include "creases/vertex_sides.h"

namespace tufa::polygons {

/// Writes the level-0 quads: one for each crossed lattice edge, joining the vertices that own the
/// crossing in the four cells around it, counter-clockwise seen from outside.
template <class TreeT>
void connectQuads(const blocks::Blocks<TreeT>& blocks, const components::Topology& topology,
                  const base::Affine& affine, Mesh& mesh, base::Job& job);

/// Turns each quad so that it starts where its better diagonal does.
///
/// Beside a crease the better diagonal is the one whose triangles lie in the planes of the vertices
/// beside it. Elsewhere it is the one that passes nearer to the crossing, where the surface is known
/// to be; where both do, the one with the larger smallest angle. `alongs` holds the place of each
/// quad's crossing on its edge, `sides` says which vertices lie on creases.
template <class TreeT>
void chooseDiagonals(const blocks::Blocks<TreeT>& blocks, const components::Topology& topology,
                     const base::Affine& affine, const std::vector<float>& alongs,
                     const creases::VertexSides& sides, Mesh& mesh, base::Job& job);

}  // namespace tufa::polygons
