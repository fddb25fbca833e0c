#pragma once

#include <tufa/mesh.h>
#include <functional>
#include <vector>

#include "base/vec3.h"
#include "chunks/cut/moved_vertex.h"
#include "intersect/surface.h"

namespace tufa::chunks {

/// Moves vertices back that have passed the plane of a triangle which they intersect, so that they
/// are `margin` off it: where sheets nearly touch, rounding takes some through others. Of each pair
/// those vertices that need the least way, up to a fiftieth of a step; of both triangles, as they
/// were when this was called. `mayMove` is asked about a vertex and its new place. Adds what was
/// moved to `changed`.
void pushApart(const std::vector<Triangle>& triangles,
               const std::vector<intersect::PolygonPair>& pairs, double margin,
               const std::function<bool(VertexIndex, const Vec3&)>& mayMove,
               std::vector<Vec3>& points, std::vector<MovedVertex>& changed);

}  // namespace tufa::chunks
