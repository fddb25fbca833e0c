#include "blocks/samples.h"

#include <cmath>

namespace tufa::blocks {
namespace {

// A row of samples along z in one block: its values, or one value for all.
template <class T>
struct Source {
  const T* values = nullptr;
  float constant = 0;
};

template <class T>
float scaled(T value, T isovalue, T factor) {
  return static_cast<float>((value - isovalue) * factor);
}

}  // namespace

template <class TreeT>
void BlockSamples::gather(const Blocks<TreeT>& blocks, const FieldScale& scale, BlockRef block,
                          const Neighbours& neighbours,
                          typename Blocks<TreeT>::Accessor& accessor) {
  using T = typename TreeT::ValueType;
  const T isovalue = static_cast<T>(scale.isovalue);
  const T factor = static_cast<T>(scale.factor);
  std::array<Source<T>, 27> sources;
  for (int i = 0; i < 27; ++i) {
    const BlockRef from = neighbours[i];
    if (from >= 0) sources[i].values = blocks.values(from);
    if (sources[i].values != nullptr) continue;
    const openvdb::Coord there = blocks.origin(block).offsetBy(
        (i / 9 - 1) * kBlockSize, (i / 3 % 3 - 1) * kBlockSize, (i % 3 - 1) * kBlockSize);
    sources[i].constant = scaled<T>(accessor.getValue(there), isovalue, factor);
  }
  for (int x = -1; x <= kBlockSize + 1; ++x) {
    for (int y = -1; y <= kBlockSize + 1; ++y) {
      const Source<T>* row = &sources[neighbourIndex(x >> 3, y >> 3, -1)];
      const int offset = cellIndex(x & 7, y & 7, 0);
      float* to = &values_[index(x, y, -1)];
      to[0] = row[0].values != nullptr ? scaled(row[0].values[offset + 7], isovalue, factor)
                                       : row[0].constant;
      if (row[1].values != nullptr) {
        for (int z = 0; z < kBlockSize; ++z) {
          to[z + 1] = scaled(row[1].values[offset + z], isovalue, factor);
        }
      } else {
        for (int z = 0; z < kBlockSize; ++z) to[z + 1] = row[1].constant;
      }
      for (int z = 0; z < 2; ++z) {
        to[z + 9] = row[2].values != nullptr ? scaled(row[2].values[offset + z], isovalue, factor)
                                             : row[2].constant;
      }
    }
  }
  if (blocks.nonFiniteValues() == 0) return;
  // Let in as outside: a voxel away, where nothing better is known.
  for (float& value : values_) value = std::isfinite(value) ? value : 1.0F;
}

template void BlockSamples::gather(const Blocks<openvdb::FloatTree>&, const FieldScale&, BlockRef,
                                   const Neighbours&, Blocks<openvdb::FloatTree>::Accessor&);
template void BlockSamples::gather(const Blocks<openvdb::DoubleTree>&, const FieldScale&, BlockRef,
                                   const Neighbours&, Blocks<openvdb::DoubleTree>::Accessor&);

}  // namespace tufa::blocks
