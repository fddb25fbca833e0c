#pragma once

#include <tufa/mesh.h>

#include "base/vec3.h"

namespace tufa::chunks {

[[nodiscard]] inline bool has(const Triangle& t, VertexIndex v) {
  return t.vertices[0] == v || t.vertices[1] == v || t.vertices[2] == v;
}

/// Whether a triangle whose corners move turns by more than the angle of `turnCosine`, or shrinks
/// to less than `leastShare` of its area.
[[nodiscard]] inline bool isTurned(const Vec3 (&before)[3], const Vec3 (&after)[3],
                                   double turnCosine, double leastShare) {
  const Vec3 m = (before[1] - before[0]).cross(before[2] - before[0]);
  const Vec3 n = (after[1] - after[0]).cross(after[2] - after[0]);
  return !(n.dot(m) >= turnCosine * n.length() * m.length() &&
           n.length() >= leastShare * m.length());
}

/// Whether two triangles that share an edge, each given by twice its area along its normal, lie
/// nearly on each other, and are no slivers: by more than 150 degrees of turn, above a twentieth of
/// a square step.
[[nodiscard]] inline bool isFold(const Vec3& m, const Vec3& n) {
  constexpr double kCosine = -0.866, kTwiceArea = 0.1;
  const double a = m.length(), b = n.length();
  return a > kTwiceArea && b > kTwiceArea && m.dot(n) < kCosine * a * b;
}

}  // namespace tufa::chunks
