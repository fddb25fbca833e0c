#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"

namespace tufa::chunks {

/// Flips the longest edges of caps: triangles with a vertex nearer than `height` to the edge
/// opposite it, between its ends. Vertices in a row along a crease make such triangles, which
/// rounding turns over. The surface moves by `height` at most. Begins with caps that have a vertex
/// marked in `marks`, or with all if that is empty. Triangles with a vertex that `stays` are left as
/// they are; adds the vertices of both triangles of each edge flipped to `changed`.
void flipCaps(const std::vector<Vec3>& points, double height, std::span<const std::uint8_t> marks,
              const std::function<bool(VertexIndex)>& stays, std::vector<Triangle>& triangles,
              std::vector<VertexIndex>& changed, base::Job& job);

}  // namespace tufa::chunks
