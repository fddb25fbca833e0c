#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "chunks/cut/chunk_planes.h"
#include "chunks/cut/moved_vertex.h"

namespace tufa::chunks {

/// Steps of the lattice within which vertices are moved to a plane.
inline constexpr double kNearPlane = 5e-3;

/// Moves vertices that lie within that of a plane across `axis` to it, unless that turns a triangle
/// or makes some intersect others; and within `flatDistance`, if that is more, where the surface
/// lies along the plane. Returns them in rising order, with steps of the lattice. Cost: a pass over
/// the vertices, and one over the triangles if there are any.
[[nodiscard]] std::vector<MovedVertex> moveToPlanes(const ChunkPlanes& planes, int axis,
                                                    double flatDistance,
                                                    const std::vector<Triangle>& triangles,
                                                    std::vector<Vec3>& points, base::Job& job);

}  // namespace tufa::chunks
