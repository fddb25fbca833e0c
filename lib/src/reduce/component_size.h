#pragma once

#include <cmath>

#include "base/vec3f.h"

namespace tufa::reduce {

using base::Vec3f;

/// Of a closed component, of the triangles that are added.
struct ComponentSize {
  float volume = 0, area = 0;

  /// All corners seen from one point near the component.
  void add(Vec3f a, Vec3f b, Vec3f c) {
    volume += dot(a, cross(b, c)) / 6;
    area += length(cross(b - a, c - a)) / 2;
  }
};

/// Whether a small component keeps its inside, and does not become so thin that rounding may take
/// it: a thousandth of a voxel, of which rounding moves places by half at most, or what it was.
[[nodiscard]] inline bool keepsInside(const ComponentSize& before, const ComponentSize& after) {
  constexpr float kLeastThickness = 1e-3f;
  if ((before.volume > 0) != (after.volume > 0) || after.volume == 0) return false;
  // Of a plate, both of whose sides are in the area.
  const float thickness = 2 * std::abs(after.volume), was = 2 * std::abs(before.volume);
  return thickness >= kLeastThickness * after.area || thickness * before.area >= was * after.area;
}

}  // namespace tufa::reduce
