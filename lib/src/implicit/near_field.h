#pragma once

#include "implicit/fields.h"

namespace tufa::implicit {

/// What is known of a field in a box.
struct NearBounds {
  Box box;
  double steepest = 0;   ///< its gradient is no longer
  double curvature = 0;  ///< its gradient changes by no more for each unit of the way
};

/// The same field with quicker bounds in a box, where each of its own would look at many parts; it
/// refers to that one.
[[nodiscard]] FieldPtr makeNearField(const Field& whole, const NearBounds& bounds);

}  // namespace tufa::implicit
