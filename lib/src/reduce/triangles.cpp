#include "reduce/triangles.h"

#include <algorithm>

namespace tufa::reduce {

bool planeParts(const Vec3f* a, const Vec3f* b, float gap) {
  // Counted from a corner: far from the origin products of coordinates are rounded to more than the
  // gap.
  const Vec3f pa[2] = {a[1] - a[0], a[2] - a[0]};
  const Vec3f pb[3] = {b[0] - a[0], b[1] - a[0], b[2] - a[0]};
  const Vec3f ea[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
  const Vec3f eb[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const Vec3f na = cross(ea[0], ea[1]), nb = cross(eb[0], eb[1]);
  const auto along = [&](Vec3f x) {
    const float l2 = squaredLength(x);
    if (!(l2 > 1e-12f)) return false;
    const float p0 = 0, p1 = dot(x, pa[0]), p2 = dot(x, pa[1]);
    const float q0 = dot(x, pb[0]), q1 = dot(x, pb[1]), q2 = dot(x, pb[2]);
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
