#include "base/interpolated_normal.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace tufa::base {

Normal interpolatedNormal(const Mesh& mesh, const Triangle& face, const Vec3& p) {
  const Vec3 a(mesh.positions[face.vertices[0]]), b(mesh.positions[face.vertices[1]]),
      c(mesh.positions[face.vertices[2]]);
  const Vec3 normal = (b - a).cross(c - a);
  const std::array<double, 3> weights{(c - b).cross(p - b).dot(normal),
                                      (a - c).cross(p - c).dot(normal),
                                      (b - a).cross(p - a).dot(normal)};
  Vec3 sum(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    sum += Vec3(mesh.normals[face.vertices[i]]) * std::max(0.0, weights[i]);
  }
  if (!(sum.squaredLength() > 0)) return mesh.normals[face.vertices[0]];
  return Normal(sum.unitOrX());
}

}  // namespace tufa::base
