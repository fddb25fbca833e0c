#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "chunks/cut/moved_vertex.h"

namespace tufa::chunks {

/// Collapses edges of a mesh that are shorter than `least`, into one of their ends, where the
/// topology and `mayGoInto` allow it, and unless `mayFold` where no fold is made, see isFold():
/// those of triangles that have a vertex marked in `marks`, or all if that is empty. Vertices that
/// nothing uses any more stay in `points`. Adds both ends to `changed`, with how far the one that
/// went is from the one that it went into at last.
void joinNearVertices(const std::vector<Vec3>& points, double least, bool mayFold,
                      std::span<const std::uint8_t> marks,
                      const std::function<bool(VertexIndex, VertexIndex)>& mayGoInto,
                      std::vector<Triangle>& triangles, std::vector<MovedVertex>& changed,
                      base::Job& job);

}  // namespace tufa::chunks
