#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "intersect/surface.h"

namespace tufa::chunks {

/// Where a vertex is.
using PlaceOfVertex = std::function<Vec3(VertexIndex)>;

/// The pairs of triangles that intersect, and of which one has a marked vertex. `placeOf`: the
/// vertices where they are tested; `at`: the same as lattice points, up to rounding. Cost: a pass
/// over all triangles, and a search among those near marked ones.
[[nodiscard]] std::vector<intersect::PolygonPair> findPairsAt(
    const std::vector<Triangle>& triangles, const std::vector<Vec3>& at,
    const PlaceOfVertex& placeOf, const std::vector<std::uint8_t>& marks, base::Job& job);

}  // namespace tufa::chunks
