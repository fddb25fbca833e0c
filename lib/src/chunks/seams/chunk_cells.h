#pragma once

#include <algorithm>
#include <cstdint>

#include "base/index_box.h"
#include "base/vec3.h"

namespace tufa::chunks {

/// Which chunk a cell lies in, and which chunks are to be made: a box of them.
struct ChunkCells {
  int level = 6;       ///< log2 of a chunk's size
  base::IndexBox own;  ///< chunks, both corners included

  static constexpr std::int32_t kNotOwn = -1;

  [[nodiscard]] Coord chunkOf(const Coord& cell) const {
    return {cell[0] >> level, cell[1] >> level, cell[2] >> level};
  }
  /// A number for each chunk to be made, kNotOwn for the others. In the order of their indices.
  [[nodiscard]] std::int32_t numberOf(const Coord& chunk) const {
    if (!own.contains(chunk)) return kNotOwn;
    const Coord dim = own.size(), at = chunk - own.min;
    return (at[0] * dim[1] + at[1]) * dim[2] + at[2];
  }
  [[nodiscard]] Coord chunkAt(std::int32_t number) const {
    const Coord dim = own.size();
    return own.min + Coord(number / (dim[1] * dim[2]), number / dim[2] % dim[1], number % dim[2]);
  }
  /// Moves lattice coordinates, counted from `from`, into the chunk of `cell` if they lie beyond
  /// its faces or on them. Strictly monotonic, so different points stay different.
  [[nodiscard]] Vec3 keepInside(Vec3 at, const Coord& from, const Coord& cell) const {
    const auto standOff = [](double distance) {
      return distance >= kOffFace ? distance : kOffFace / (1 + kOffFace - distance);
    };
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = ((cell[axis] >> level) << level) - from[axis];
      const double upper = lower + (1 << level);
      if (at[axis] - lower < kOffFace) at[axis] = lower + standOff(at[axis] - lower);
      if (upper - at[axis] < kOffFace) at[axis] = upper - standOff(upper - at[axis]);
    }
    return at;
  }
  /// Distance from the faces of its chunk, in voxels, below which a vertex is moved. One on a face
  /// comes to nearly this distance, one a voxel beyond it to half of it.
  static constexpr double kOffFace = 0.01;

  [[nodiscard]] std::int32_t count() const {
    const Coord size = own.size();
    return size[0] * size[1] * size[2];
  }
};

}  // namespace tufa::chunks
