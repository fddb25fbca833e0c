#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "uniform/surface_view.h"

namespace tufa::uniform {

/// Writes the quads of the uniform mesh: one for each crossed lattice edge that is not open,
/// joining the vertices that own the crossing in the four cells around it, counter-clockwise seen
/// from outside. Away from creases each starts at an end of its better diagonal; see SplitChooser.
void connectQuads(const SurfaceView& context, Mesh& mesh, base::Job& job);

/// Makes the quads near creases start at an end of their better diagonal. Their vertices must be
/// where they will stay.
void splitAtCreases(const SurfaceView& context, Mesh& mesh, base::Job& job);

/// The same for some quads, given in rising order.
void splitAgain(const SurfaceView& context, const std::vector<std::uint32_t>& quads, Mesh& mesh,
                base::Job& job);

/// Where the surface crosses the lattice edges of some quads, given in rising order, by linear
/// interpolation.
[[nodiscard]] std::vector<Position> quadCrossings(const SurfaceView& context,
                                                  const std::vector<std::uint32_t>& quads,
                                                  base::Job& job);

}  // namespace tufa::uniform
