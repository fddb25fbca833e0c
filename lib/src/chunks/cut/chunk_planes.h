#pragma once

#include <tufa/coord.h>
#include <array>
#include <cmath>
#include <cstdint>

namespace tufa::chunks {

/// Where a coordinate lies among the planes across an axis: 2n on plane n, 2n + 1 between planes n
/// and n + 1. Planes are eight voxels apart or more, so that a number of them has 29 bits.
using Place = std::int32_t;
using PlacesAmongPlanes = std::array<Place, 3>;

/// The planes between chunks of `size` voxels, in a lattice whose points are counted from `origin`.
class ChunkPlanes {
 public:
  ChunkPlanes(const Coord& origin, int size) : origin_(origin), size_(size) {}

  /// The coordinate of a plane.
  [[nodiscard]] double at(int axis, std::int64_t plane) const {
    return static_cast<double>(plane * size_ - origin_[axis]);
  }
  /// That of the plane nearest to a coordinate.
  [[nodiscard]] double nearest(int axis, double x) const {
    return at(axis, std::llround(inChunks(axis, x)));
  }
  [[nodiscard]] Place placeOf(int axis, double x) const {
    const auto n = static_cast<std::int64_t>(std::floor(inChunks(axis, x)));
    return static_cast<Place>(x == at(axis, n) ? 2 * n : 2 * n + 1);
  }

 private:
  [[nodiscard]] double inChunks(int axis, double x) const {
    return (x + static_cast<double>(origin_[axis])) / static_cast<double>(size_);
  }

  Coord origin_;
  std::int64_t size_;
};

}  // namespace tufa::chunks
