#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "grid/blocks.h"
#include "grid/field.h"

namespace tufa::grid {

/// Reads single samples around one block, scaled to voxels, negative inside.
class SampleReader {
 public:
  SampleReader(const Blocks& blocks, const FieldScale& scale, BlockRef block,
               const Neighbours& neighbours, Accessor& accessor)
      : blocks_(blocks),
        scale_(scale),
        block_(block),
        neighbours_(neighbours),
        accessor_(accessor) {}

  /// The sample at a lattice point -8..15 steps from the block's origin on each axis.
  [[nodiscard]] double at(int x, int y, int z) const {
    const BlockRef block = neighbours_[neighbourIndex(x >> 3, y >> 3, z >> 3)];
    if (block == kMissingBlock) {
      std::array<int, 3> last{x, y, z};
      int& across = last[blocks_.slab().axis];
      across = across < 0 ? 0 : kBlockSize - 1;
      return at(last[0], last[1], last[2]);
    }
    const LeafRef leaf = block < 0 ? kNoLeaf : blocks_.leaf(block);
    return scaled(leaf != kNoLeaf ? blocks_.tree().leafValue(leaf, cellIndex(x & 7, y & 7, z & 7))
                                  : accessor_.value(blocks_.origin(block_).offsetBy(x, y, z)));
  }

  /// For each axis, the lattice points of slab x whose edge upward joins two active samples.
  [[nodiscard]] std::array<std::uint64_t, 3> activeEdges(int x) const {
    const std::uint64_t here = active(0, 0, 0, x);
    return {here & (x < kBlockSize - 1 ? active(0, 0, 0, x + 1) : active(1, 0, 0, 0)),
            here & stepY(here, active(0, 1, 0, x)), here & stepZ(here, active(0, 0, 1, x))};
  }

 private:
  [[nodiscard]] double scaled(double value) const {
    // A sample that is not finite counts as outside.
    if (!std::isfinite(value)) return 1;
    return (value - scale_.isovalue) * scale_.factor;
  }

  [[nodiscard]] std::uint64_t active(int dx, int dy, int dz, int x) const {
    const BlockRef block = neighbours_[neighbourIndex(dx, dy, dz)];
    if (block >= 0) return blocks_.active(block, x, accessor_);
    const bool on = accessor_.isActive(
        blocks_.origin(block_).offsetBy(dx * kBlockSize, dy * kBlockSize, dz * kBlockSize));
    return on ? ~std::uint64_t{0} : 0;
  }

  const Blocks& blocks_;
  const FieldScale& scale_;
  BlockRef block_;
  const Neighbours& neighbours_;
  Accessor& accessor_;
};

/// The samples of a block and of one layer below and two above it on each axis, in voxels, negative
/// inside: what its cells and the central differences at their corners need.
class BlockSamples {
 public:
  static constexpr int kSize = kBlockSize + 3;
  static constexpr int kCount = kSize * kSize * kSize;
  static constexpr int kStrideX = kSize * kSize;
  static constexpr int kStrideY = kSize;

  /// Position of lattice point (x, y, z), each -1..9, in the array.
  [[nodiscard]] static constexpr int index(int x, int y, int z) {
    return (x + 1) * kStrideX + (y + 1) * kStrideY + z + 1;
  }
  [[nodiscard]] static constexpr int stride(int axis) {
    return axis == 0 ? kStrideX : axis == 1 ? kStrideY : 1;
  }
  [[nodiscard]] float operator[](int index) const { return values_[index]; }
  [[nodiscard]] const float* data() const { return values_.data(); }

  /// Reads the samples of a block. One virtual call for all 1,331.
  void gather(const Blocks& blocks, const FieldScale& scale, BlockRef block,
              const Neighbours& neighbours, Accessor& accessor);

 private:
  void continueMissing(int axis, const Neighbours& neighbours);

  std::array<float, kCount> values_;
};

}  // namespace tufa::grid
