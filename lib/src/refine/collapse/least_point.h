#pragma once

#include "base/quadric.h"

namespace tufa::refine {

/// The point of least error of a quadric. Directions that its planes leave free stay near the
/// origin, which should therefore be the point to keep.
[[nodiscard]] Vec3 leastPoint(const base::Quadric& planes);

}  // namespace tufa::refine
