#pragma once

#include "base/vec3.h"

namespace tufa::chunks {

/// Whether a triangle whose corners move turns by more than the angle of `turnCosine`, or shrinks
/// to less than `leastShare` of its area.
[[nodiscard]] inline bool isTurned(const Vec3 (&before)[3], const Vec3 (&after)[3],
                                   double turnCosine, double leastShare) {
  const Vec3 m = (before[1] - before[0]).cross(before[2] - before[0]);
  const Vec3 n = (after[1] - after[0]).cross(after[2] - after[0]);
  return !(n.dot(m) >= turnCosine * n.length() * m.length() &&
           n.length() >= leastShare * m.length());
}

}  // namespace tufa::chunks
