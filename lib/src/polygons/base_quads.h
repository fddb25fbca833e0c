#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "base/affine.h"
#include "base/job.h"
#include "blocks/blocks.h"
#include "components/topology.h"

namespace tufa::polygons {

/// Writes the level-0 quads: one for each crossed lattice edge, joining the vertices that own the
/// crossing in the four cells around it, counter-clockwise seen from outside, each starting where
/// the better diagonal does. `alongs` holds the place of each quad's crossing on its edge.
///
/// The better diagonal is the one that passes nearer to the crossing, where the surface is known to
/// be; where both do, the one with the larger smallest angle.
template <class TreeT>
void writeBaseQuads(const blocks::Blocks<TreeT>& blocks, const components::Topology& topology,
                    const base::Affine& affine, const std::vector<float>& alongs, Mesh& mesh,
                    base::Job& job);

}  // namespace tufa::polygons
