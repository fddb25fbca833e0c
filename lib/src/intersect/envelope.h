#pragma once

#include <algorithm>

#include "base/vec3.h"

namespace tufa::intersect {

/// The planes of triangles with a common corner, and what must be behind and in front of them.
class Between {
 public:
  Between(const Vec3& corner, const Vec3& inner, const Vec3& outer, double margin)
      : inner_(inner - corner),
        outer_(outer - corner),
        innerDistance2_(4 * inner_.squaredLength()),
        outerDistance2_(4 * outer_.squaredLength()),
        margin2_(2 * margin * margin) {}

  /// Whether `inner` is behind the plane of a triangle and `outer` in front, even if each of its
  /// corners moves by half of the margin. `q` and `r` are the other two, seen from the common
  /// corner. That moves the plane at a point by no more than the margin times 1 + 2 d / h, h being
  /// the least height of the triangle and d the distance of the point from a corner: the plane of a
  /// needle turns easily. All squared, so that no square root is needed.
  [[nodiscard]] bool areSeparated(const Vec3& q, const Vec3& r) const {
    const Vec3 normal = q.cross(r);
    const double before = normal.dot(outer_), behind = -normal.dot(inner_);
    if (!(before > 0 && behind > 0)) return false;
    const double longest2 =
        std::max({q.squaredLength(), (r - q).squaredLength(), r.squaredLength()});
    const double area2 = normal.squaredLength();
    return before * before > margin2_ * (area2 + outerDistance2_ * longest2) &&
           behind * behind > margin2_ * (area2 + innerDistance2_ * longest2);
  }

 private:
  Vec3 inner_, outer_;
  double innerDistance2_, outerDistance2_, margin2_;
};

}  // namespace tufa::intersect
