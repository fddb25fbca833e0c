#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec3.h"
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

// Distances, after Ericson, Real-Time Collision Detection (2005), 5.1. Inline: they are asked for
// so often that calls would show.

[[nodiscard]] inline double dot(const Vec3& a, const Vec3& b) { return a.dot(b); }

/// The point of a triangle that is nearest to p. `V`: Vec3f or Vec3. Of a sliver a hundred times as
/// long as it is wide single precision may give another point, but one of the triangle.
template <class V>
[[nodiscard]] inline V closestOnTriangle(const V& p, const V& a, const V& b, const V& c) {
  const V ab = b - a, ac = c - a, ap = p - a;
  const auto d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const V bp = p - b;
  const auto d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const auto vc = d1 * d4 - d3 * d2;
  // Strictly: of ends at one point there is no way from one to the other to divide.
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return a + ab * (d1 / (d1 - d3));
  const V cp = p - c;
  const auto d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const auto vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return a + ac * (d2 / (d2 - d6));
  const auto va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0) {
    return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  }
  if (!(va > 0 && vb > 0 && vc > 0)) return a;  // of a sliver
  const auto s = 1 / (va + vb + vc);
  return a + ab * (vb * s) + ac * (vc * s);
}

[[nodiscard]] inline float squaredDistanceToTriangle(Vec3f p, Vec3f a, Vec3f b, Vec3f c) {
  return squaredLength(p - closestOnTriangle(p, a, b, c));
}

/// The same in double precision, for slivers.
[[nodiscard]] inline double exactSquaredDistanceToTriangle(Vec3f p, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3 q(p);
  return (q - closestOnTriangle(q, Vec3(a), Vec3(b), Vec3(c))).squaredLength();
}

/// Between the segments from p1 to q1 and from p2 to q2.
[[nodiscard]] inline float squaredDistanceOfSegments(Vec3f p1, Vec3f q1, Vec3f p2, Vec3f q2) {
  const Vec3f d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const float a = dot(d1, d1), e = dot(d2, d2), f = dot(d2, r), c = dot(d1, r), b = dot(d1, d2);
  const float det = a * e - b * b;
  float s = det > 1e-12f * a * e ? std::clamp((b * f - c * e) / det, 0.0f, 1.0f) : 0.f;
  float t = e > 0 ? (b * s + f) / e : 0.f;
  if (t < 0) {
    t = 0;
    s = a > 0 ? std::clamp(-c / a, 0.0f, 1.0f) : 0.f;
  } else if (t > 1) {
    t = 1;
    s = a > 0 ? std::clamp((b - c) / a, 0.0f, 1.0f) : 0.f;
  }
  return squaredLength((p1 + d1 * s) - (p2 + d2 * t));
}

/// Of a triangle seen from the origin, with the sign of its orientation (van Oosterom and Strackee
/// 1983).
[[nodiscard]] inline float solidAngle(Vec3f a, Vec3f b, Vec3f c) {
  const float la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(dot(a, cross(b, c)),
                        la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// Whether a plane parts two triangles (three corners each) by at least `gap`. Never true for
/// triangles that meet; looks along all face normals and products of edges, so that it is never
/// false for triangles that are much farther apart than `gap`.
[[nodiscard]] bool planeParts(const Vec3f* a, const Vec3f* b, float gap);

}  // namespace tufa::reduce
