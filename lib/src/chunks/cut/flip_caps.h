#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "chunks/cut/moved_vertex.h"

namespace tufa::chunks {

/// Flips the longest edges of caps: triangles with a vertex nearer than `height` to the edge
/// opposite it, between its ends. Vertices in a row along a crease make such triangles, which
/// rounding turns over. Begins with caps that have a vertex marked in `marks`, or with all if that
/// is empty. Edges are flipped if that makes no fold, see isFold(), and `mayFlip` says so of the
/// vertices of both triangles. These are then added to `changed`, with how far that has moved the
/// triangles at most.
void flipCaps(const std::vector<Vec3>& points, double height, std::span<const std::uint8_t> marks,
              const std::function<bool(const std::array<VertexIndex, 4>&)>& mayFlip,
              std::vector<Triangle>& triangles, std::vector<MovedVertex>& changed, base::Job& job);

}  // namespace tufa::chunks
