#pragma once

#include <tufa/mesh.h>

#include "base/vec3.h"

namespace tufa::base {

/// The normal of a mesh at the point of a face next to `p`: those of its corners, weighted by the
/// barycentric coordinates there. The first corner's, where they cancel out.
[[nodiscard]] Normal interpolatedNormal(const Mesh& mesh, const Triangle& face, const Vec3& p);

}  // namespace tufa::base
