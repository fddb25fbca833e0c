#include "reduce/triangles.h"

#include <algorithm>

namespace tufa::reduce {
namespace {

Vec3f closestOnTriangle(Vec3f p, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3f ab = b - a, ac = c - a, ap = p - a;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3f bp = p - b;
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const Vec3f cp = p - c;
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  }
  const float s = 1 / (va + vb + vc);
  return a + ab * (vb * s) + ac * (vc * s);
}

}  // namespace

float squaredDistanceToTriangle(Vec3f p, Vec3f a, Vec3f b, Vec3f c) {
  return squaredLength(p - closestOnTriangle(p, a, b, c));
}

float squaredDistanceOfSegments(Vec3f p1, Vec3f q1, Vec3f p2, Vec3f q2) {
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

bool planeParts(const Vec3f* a, const Vec3f* b, float gap) {
  const Vec3f ea[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
  const Vec3f eb[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const Vec3f na = cross(ea[0], ea[1]), nb = cross(eb[0], eb[1]);
  const auto along = [&](Vec3f x) {
    const float l2 = squaredLength(x);
    if (!(l2 > 1e-12f)) return false;
    const float p0 = dot(x, a[0]), p1 = dot(x, a[1]), p2 = dot(x, a[2]);
    const float q0 = dot(x, b[0]), q1 = dot(x, b[1]), q2 = dot(x, b[2]);
    const float g = std::max(std::min(std::min(q0, q1), q2) - std::max(std::max(p0, p1), p2),
                             std::min(std::min(p0, p1), p2) - std::max(std::max(q0, q1), q2));
    return g > 0 && g * g > gap * gap * l2;
  };
  if (along(na) || along(nb)) return true;
  for (const Vec3f& x : ea) {
    for (const Vec3f& y : eb) {
      if (along(cross(x, y))) return true;
    }
  }
  for (int i = 0; i < 3; ++i) {  // triangles in one plane
    if (along(cross(na, ea[i])) || along(cross(nb, eb[i]))) return true;
  }
  return false;
}

}  // namespace tufa::reduce
