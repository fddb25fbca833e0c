#pragma once

#include <algorithm>

#include "base/vec3.h"

namespace tufa::intersect {

/// Whether `inner` is behind the plane of a triangle and `outer` in front, even if each of its
/// corners moves by half of `margin`. That moves the plane at a point by no more than the margin
/// times 1 + 2 d / h, h being the least height of the triangle and d the distance of the point from
/// a corner: the plane of a needle turns easily. All squared, so that no square root is needed.
[[nodiscard]] inline bool parts(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& inner,
                                const Vec3& outer, double margin) {
  const Vec3 normal = (q - p).cross(r - p);
  const double before = normal.dot(outer - p), behind = normal.dot(p - inner);
  if (!(before > 0 && behind > 0)) return false;
  const double longest2 =
      std::max({(q - p).squaredLength(), (r - q).squaredLength(), (p - r).squaredLength()});
  const double area2 = normal.squaredLength(), margin2 = 2 * margin * margin;
  const auto least2 = [&](const Vec3& point) {
    return margin2 * (area2 + 4 * (point - p).squaredLength() * longest2);
  };
  return before * before > least2(outer) && behind * behind > least2(inner);
}

}  // namespace tufa::intersect
