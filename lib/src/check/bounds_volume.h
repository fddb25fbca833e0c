#pragma once

#include "check/faces.h"

namespace tufa::checks {

/// CGAL's does_bound_a_volume() for the proper faces, which must form a closed, oriented 2-manifold
/// without intersections: CGAL's behaviour is undefined for others. False if CGAL refuses the mesh.
[[nodiscard]] bool cgalBoundsVolume(const Faces& faces);

}  // namespace tufa::checks
