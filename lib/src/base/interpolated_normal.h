#pragma once

#include <tufa/mesh.h>

#include <array>

#include "base/vec3.h"

namespace tufa::base {

/// The normal at the point of a triangle next to `p`: those of its corners, weighted by the
/// barycentric coordinates there. The first corner's, where they cancel out.
[[nodiscard]] Normal interpolatedNormal(const std::array<Vec3, 3>& corners,
                                        const std::array<Normal, 3>& normals, const Vec3& p);

}  // namespace tufa::base
