#pragma once

#include <tufa/implicit.h>

#include <array>
#include <bit>
#include <cstdint>

#include "base/vec3.h"

namespace tufa::voxelize_field {

/// A bit for each sample of a block of 8^3: a word a slice of x, bit 8 y + z.
using BlockMask = std::array<std::uint64_t, 8>;

/// The samples of one block of the lattice, and a field that holds around it.
struct SampledBlock {
  static constexpr int kSide = 8;

  const implicit::Field& field;
  std::array<int, 3> origin;  ///< of its first sample
  double voxelSize;
  BlockMask inside{};   ///< samples below 0
  BlockMask sampled{};  ///< those that the field was evaluated for, not its bounds

  [[nodiscard]] Vec3 point(int x, int y, int z) const {
    return Vec3(origin[0] + x, origin[1] + y, origin[2] + z) * voxelSize;
  }
  [[nodiscard]] static bool holds(int x, int y, int z) {
    const auto within = [](int c) { return c >= 0 && c < kSide; };
    return within(x) && within(y) && within(z);
  }
  [[nodiscard]] bool isSampled(int x, int y, int z) const {
    return (sampled[x] >> (kSide * y + z) & 1) != 0;
  }
  /// Whether a sample is inside. Beyond the block the field is asked.
  [[nodiscard]] bool isInside(int x, int y, int z) const {
    if (!holds(x, y, z)) return field.value(point(x, y, z)) < 0;
    return (inside[x] >> (kSide * y + z) & 1) != 0;
  }
};

/// What the samples do not show.
struct HiddenParts {
  std::size_t found = 0;
  std::size_t undecided = 0;
  Vec3 first{0.0};  ///< a place in the first voxel of either
};

/// Looks for pieces of the surface in the cubes around samples all of whose 26 neighbours lie on
/// the same side. Bounds say for nearly all of them that there is none; in the others a point of
/// the other side is sought, by halving.
[[nodiscard]] HiddenParts findHiddenParts(const SampledBlock& block);

}  // namespace tufa::voxelize_field
