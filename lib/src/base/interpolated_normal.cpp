#include "base/interpolated_normal.h"

#include <algorithm>
#include <cstddef>

namespace tufa::base {

Normal interpolatedNormal(const std::array<Vec3, 3>& corners, const std::array<Normal, 3>& normals,
                          const Vec3& p) {
  const auto& [a, b, c] = corners;
  const Vec3 normal = (b - a).cross(c - a);
  const std::array<double, 3> weights{(c - b).cross(p - b).dot(normal),
                                      (a - c).cross(p - c).dot(normal),
                                      (b - a).cross(p - a).dot(normal)};
  Vec3 sum(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    sum += Vec3(normals[i]) * std::max(0.0, weights[i]);
  }
  if (!(sum.squaredLength() > 0)) return normals[0];
  return Normal(sum.unitOrX());
}

}  // namespace tufa::base
