#pragma once

#include "base/vec3f.h"

namespace tufa::reduce {

using base::Vec3f;

/// Squared sine of a triangle's smallest angle, which is opposite its shortest edge: from the
/// square of twice its area and the squared lengths of its edges.
[[nodiscard]] inline float leastSine2(float area2, float x, float y, float z) {
  const float product = x * y * z;
  return product > 0 ? area2 * std::min(std::min(x, y), z) / product : 0;
}
[[nodiscard]] inline float leastSine2(Vec3f a, Vec3f b, Vec3f c) {
  return leastSine2(squaredLength(cross(b - a, c - a)), squaredLength(b - a), squaredLength(c - b),
                    squaredLength(a - c));
}

// Squared distances, after Ericson, Real-Time Collision Detection (2005), 5.1.

[[nodiscard]] float squaredDistanceToTriangle(Vec3f p, Vec3f a, Vec3f b, Vec3f c);
/// Between the segments from p1 to q1 and from p2 to q2.
[[nodiscard]] float squaredDistanceOfSegments(Vec3f p1, Vec3f q1, Vec3f p2, Vec3f q2);

/// Whether a plane parts two triangles (three corners each) by at least `gap`. Never true for
/// triangles that meet; looks along all face normals and products of edges, so that it is never
/// false for triangles that are much farther apart than `gap`.
[[nodiscard]] bool planeParts(const Vec3f* a, const Vec3f* b, float gap);

}  // namespace tufa::reduce
