#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "uniform/surface_view.h"

namespace tufa::uniform {

/// Writes the level-0 quads: one for each crossed lattice edge, joining the vertices that own the
/// crossing in the four cells around it, counter-clockwise seen from outside. Away from creases
/// each starts where its better diagonal does; see SplitChooser.
void connectQuads(const SurfaceView& context, Mesh& mesh, base::Job& job);

/// Turns the quads near creases so that they start where their better diagonal does. Their vertices
/// must be where they will stay.
void splitAtCreases(const SurfaceView& context, Mesh& mesh, base::Job& job);

/// Where the surface crosses the lattice edges of some quads, sorted, by linear interpolation.
[[nodiscard]] std::vector<Position> quadCrossings(const SurfaceView& context,
                                                  const std::vector<std::uint32_t>& quads,
                                                  base::Job& job);

}  // namespace tufa::uniform
