#pragma once

#include "base/quadric.h"

namespace tufa::refine {

/// The point of least error of a quadric; directions that its planes leave free stay near the
/// origin.
[[nodiscard]] Vec3 leastPoint(const base::Quadric& planes);

}  // namespace tufa::refine
