#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "base/vec3.h"

namespace tufa::chunks {

/// Flips the longest edges of caps: triangles with a vertex nearer than `height` to the edge
/// opposite it, between its ends. Vertices in a row along a crease make such triangles, which
/// rounding turns over. The surface moves by `height` at most.
void flipCaps(const std::vector<Vec3>& points, double height, std::vector<Triangle>& triangles);

}  // namespace tufa::chunks
