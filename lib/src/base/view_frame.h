#pragma once

#include <cmath>
#include <numbers>

#include "base/vec3.h"

namespace tufa::base {

/// What is right, up and towards the eye in a picture: an orthonormal frame.
struct ViewFrame {
  Vec3 right, up, toEye;
};

/// `azimuth` is the angle of the eye about z from the x axis; `elevation` is over the xy plane;
/// both in degrees. If `yUp`, y takes the place of z, z that of x, and x that of y.
inline ViewFrame viewFrame(double azimuth, double elevation, bool yUp) {
  const double a = azimuth * std::numbers::pi / 180;
  const double e = elevation * std::numbers::pi / 180;
  ViewFrame frame;
  frame.toEye = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
  frame.right = {-std::sin(a), std::cos(a), 0};
  if (yUp) {
    for (Vec3* v : {&frame.toEye, &frame.right}) *v = {(*v)[1], (*v)[2], (*v)[0]};
  }
  frame.up = frame.toEye.cross(frame.right);
  return frame;
}

}  // namespace tufa::base
