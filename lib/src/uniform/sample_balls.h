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
  SampleBalls(const grid::FieldScale& scale, grid::Accessor& accessor)
      : scale_(scale), accessor_(accessor) {}

  /// Whether a point lies in none of the balls of the 64 samples around it. `point` is counted from
  /// the lattice point `from`. Reads the samples one by one: a microsecond.
  [[nodiscard]] bool admit(const Vec3& point, const Coord& from) const;

 private:
  const grid::FieldScale& scale_;
  grid::Accessor& accessor_;
};

}  // namespace tufa::uniform
