#include "grid/samples.h"

#include <cmath>

namespace tufa::grid {

void BlockSamples::gather(const Blocks& blocks, const FieldScale& scale, BlockRef block,
                          const Neighbours& neighbours, Accessor& accessor) {
  std::array<LeafRef, 27> leaves;
  for (int i = 0; i < 27; ++i) {
    leaves[i] = neighbours[i] >= 0 ? blocks.leaf(neighbours[i]) : kNoLeaf;
  }
  accessor.gather(leaves, blocks.origin(block), scale, values_.data());
  if (blocks.nonFiniteValues() == 0) return;
  // Samples that are not finite count as outside, one voxel away.
  for (float& value : values_) value = std::isfinite(value) ? value : 1.0F;
}

}  // namespace tufa::grid
