#include "grid/samples.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tufa::grid {

void BlockSamples::gather(const Blocks& blocks, const FieldScale& scale, BlockRef block,
                          const Neighbours& neighbours, Accessor& accessor) {
  std::array<LeafRef, 27> leaves;
  for (int i = 0; i < 27; ++i) {
    leaves[i] = neighbours[i] >= 0 ? blocks.leaf(neighbours[i]) : kNoLeaf;
  }
  accessor.gather(leaves, blocks.origin(block), scale, values_.data());
  if (blocks.isPart()) continueMissing(blocks.slab().axis, neighbours);
  if (blocks.nonFiniteValues() == 0) return;
  // Samples that are not finite count as outside, one voxel away.
  for (float& value : values_) value = std::isfinite(value) ? value : 1.0F;
}

void BlockSamples::continueMissing(int axis, const Neighbours& neighbours) {
  if (std::find(neighbours.begin(), neighbours.end(), kMissingBlock) == neighbours.end()) return;
  for (int x = -1; x < kSize - 1; ++x) {
    for (int y = -1; y < kSize - 1; ++y) {
      for (int z = -1; z < kSize - 1; ++z) {
        if (neighbours[neighbourIndex(x >> 3, y >> 3, z >> 3)] != kMissingBlock) continue;
        const std::array<int, 3> at{x, y, z};
        const int last = at[axis] < 0 ? 0 : kBlockSize - 1;
        values_[index(x, y, z)] = values_[index(x, y, z) + (last - at[axis]) * stride(axis)];
      }
    }
  }
}

}  // namespace tufa::grid
