#pragma once

#include <tufa/coord.h>
#include <ostream>

#include "base/vec3.h"

// How messages of failed tests show the library's coordinates and vectors.

namespace tufa {

inline std::ostream& operator<<(std::ostream& out, const Coord& c) {
  return out << '[' << c[0] << ", " << c[1] << ", " << c[2] << ']';
}

inline std::ostream& operator<<(std::ostream& out, const Vec3& v) {
  return out << '(' << v[0] << ", " << v[1] << ", " << v[2] << ')';
}

}  // namespace tufa
