#pragma once

#include "base/vec3.h"
#include "grid/field.h"
#include "grid/tree.h"

namespace tufa::uniform {

/// Balls around the samples of a distance field, each as large as the sample's distance: the
/// surface enters none of them. A point where only continuations of two sheets meet, as in front of
/// a blunt edge, lies in one. For one thread.
class SampleBalls {
 public:
  /// Voxels by which the balls are smaller than the distances say.
  static constexpr float kSlack = 0.06F;

  /// Points are counted from the lattice point `origin`.
  SampleBalls(const grid::FieldScale& scale, grid::Accessor& accessor, const Coord& origin)
      : scale_(scale), accessor_(accessor), origin_(origin) {}

  /// Whether a point lies in none of the balls of the 64 samples around it. Reads them one by one:
  /// a microsecond.
  [[nodiscard]] bool admit(const Vec3& point) const;

 private:
  const grid::FieldScale& scale_;
  grid::Accessor& accessor_;
  Coord origin_;
};

}  // namespace tufa::uniform
