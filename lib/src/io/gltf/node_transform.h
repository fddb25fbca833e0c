#pragma once

#include <array>

#include "base/vec3.h"

namespace tufa::io::glb {

/// The transform of a node: points are row vectors, p * rows 0 to 2 + row 3.
struct NodeTransform {
  std::array<Vec3, 4> rows = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, 0)};

  [[nodiscard]] Vec3 ofVector(const Vec3& v) const {
    return rows[0] * v[0] + rows[1] * v[1] + rows[2] * v[2];
  }
  [[nodiscard]] Vec3 ofPoint(const Vec3& p) const { return ofVector(p) + rows[3]; }
  [[nodiscard]] bool isMirrored() const { return rows[0].dot(rows[1].cross(rows[2])) < 0; }
  /// First this, then the transform of the node above.
  [[nodiscard]] NodeTransform under(const NodeTransform& parent) const {
    return {{parent.ofVector(rows[0]), parent.ofVector(rows[1]), parent.ofVector(rows[2]),
             parent.ofPoint(rows[3])}};
  }
};

}  // namespace tufa::io::glb
