#pragma once

#include <tufa/mesh.h>
#include <functional>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"

namespace tufa::chunks {

/// Collapses edges of a mesh that are shorter than `least`, into one of their ends, where the
/// topology and `mayGoInto` allow it. Vertices that nothing uses any more stay in `points`. Returns
/// the length of the longest edge collapsed, and adds the vertices that are left of all of them to
/// `changed`.
double joinNearVertices(const std::vector<Vec3>& points, double least,
                        const std::function<bool(VertexIndex, VertexIndex)>& mayGoInto,
                        std::vector<Triangle>& triangles, std::vector<VertexIndex>& changed,
                        base::Job& job);

}  // namespace tufa::chunks
