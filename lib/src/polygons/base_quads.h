#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

#include "base/affine.h"
#include "base/job.h"
#include "blocks/blocks.h"
#include "blocks/field.h"
#include "components/topology.h"
#include "creases/vertex_sides.h"

namespace tufa::polygons {

/// What the quads are made from.
template <class TreeT>
struct QuadContext {
  const blocks::Blocks<TreeT>& blocks;
  const components::Topology& topology;
  const blocks::FieldScale& scale;
  const base::Affine& affine;
  const creases::VertexSides& sides;  ///< which vertices lie near or on creases
};

/// Writes the level-0 quads: one for each crossed lattice edge, joining the vertices that own the
/// crossing in the four cells around it, counter-clockwise seen from outside. Away from creases
/// each starts where its better diagonal does; see SplitChooser.
template <class TreeT>
void connectQuads(const QuadContext<TreeT>& context, Mesh& mesh, base::Job& job);

/// Turns the quads near creases so that they start where their better diagonal does. Their vertices
/// must be where they will stay.
template <class TreeT>
void splitAtCreases(const QuadContext<TreeT>& context, Mesh& mesh, base::Job& job);

/// Where the surface crosses the lattice edges of some quads, sorted, by linear interpolation.
template <class TreeT>
[[nodiscard]] std::vector<Position> quadCrossings(const QuadContext<TreeT>& context,
                                                  const std::vector<std::uint32_t>& quads,
                                                  base::Job& job);

}  // namespace tufa::polygons
