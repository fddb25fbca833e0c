#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "base/vec3.h"

namespace tufa::uniform {

/// Points that are asked whether one of them is near a place. Each answer looks at 27 cubes.
class PointGrid {
 public:
  /// `radius`: what is nearer is near.
  explicit PointGrid(double radius) : radius_(radius) {}

  void add(const Vec3& point) { points_.emplace(keyOf(point, 0, 0, 0), point); }

  [[nodiscard]] bool hasNear(const Vec3& place) const {
    for (int n = 0; n < 27; ++n) {
      const auto [begin, end] =
          points_.equal_range(keyOf(place, n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
      for (auto at = begin; at != end; ++at) {
        if ((at->second - place).squaredLength() < radius_ * radius_) return true;
      }
    }
    return false;
  }

 private:
  // Of the cube with sides of one radius that a point is in, or of one so many cubes on. Cubes may
  // share a key: distances decide.
  [[nodiscard]] std::uint64_t keyOf(const Vec3& point, int dx, int dy, int dz) const {
    std::uint64_t key = 0;
    const int steps[] = {dx, dy, dz};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto cube = static_cast<std::int64_t>(std::floor(point[axis] / radius_));
      key = (key ^ static_cast<std::uint64_t>(cube + steps[axis])) * 0x9E3779B97F4A7C15U;
      key ^= key >> 32;
    }
    return key;
  }

  double radius_;
  std::unordered_multimap<std::uint64_t, Vec3> points_;
};

}  // namespace tufa::uniform
