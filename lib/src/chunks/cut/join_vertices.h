#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"

namespace tufa::chunks {

/// Collapses edges of a mesh that are shorter than `least`, into one of their ends, where the
/// topology and `mayGoInto` allow it: those of triangles that have a vertex marked in `marks`, or
/// all if that is empty. Vertices that nothing uses any more stay in `points`. Returns how far
/// a vertex is at most from the one that it went into at last, and adds those that are left to
/// `changed`.
double joinNearVertices(const std::vector<Vec3>& points, double least,
                        std::span<const std::uint8_t> marks,
                        const std::function<bool(VertexIndex, VertexIndex)>& mayGoInto,
                        std::vector<Triangle>& triangles, std::vector<VertexIndex>& changed,
                        base::Job& job);

}  // namespace tufa::chunks
