#pragma once

#include <tufa/mesh.h>
#include <cstddef>
#include <span>

namespace tufa::base {

/// The smallest angle of some triangles.
struct SmallAngles {
  double smallest = 180;  ///< degrees
  std::size_t below = 0;  ///< triangles with an angle below the one asked for

  /// Adds triangles; `asked` is in degrees.
  void add(std::span<const Position> positions, std::span<const Triangle> triangles, double asked);
};

}  // namespace tufa::base
