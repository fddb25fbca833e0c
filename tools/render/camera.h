#pragma once

#include "base/vec3.h"

namespace tufa::render {

/// An orthographic view: x to the right, y down, in pixels; depth grows away from the eye.
struct Camera {
  Vec3 right, up, toEye;  ///< an orthonormal frame
  Vec3 centre;            ///< shown in the middle of the picture
  double pixels = 1;      ///< for each world unit
  double halfWidth = 0;   ///< of the picture, in pixels
  double halfHeight = 0;

  /// From there as base::viewFrame() says, in degrees.
  static Camera looking(double azimuth, double elevation, bool yUp);

  [[nodiscard]] Vec3 project(const Vec3& p) const {
    const Vec3 d = p - centre;
    return {halfWidth + pixels * right.dot(d), halfHeight - pixels * up.dot(d),
            -pixels * toEye.dot(d)};
  }

  /// The point that project() takes there.
  [[nodiscard]] Vec3 unproject(const Vec3& q) const {
    return centre + ((q[0] - halfWidth) * right + (halfHeight - q[1]) * up - q[2] * toEye) / pixels;
  }
};

}  // namespace tufa::render
