#include "blocks/samples.h"

#include <cmath>

namespace tufa::blocks {
namespace {

// The samples of one block: those of a leaf, or eight equal ones that stand for each row of a tile.
template <class T>
struct Source {
  const T* values = nullptr;
  int mask = 0;  // keeps the row's part of an index in a leaf, drops it in a tile
  std::array<T, kBlockSize> tileRow;

  [[nodiscard]] const T* row(int first) const { return values + (first & mask); }
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
    sources[i].mask = ~0;
    if (sources[i].values != nullptr) continue;
    const openvdb::Coord there = blocks.origin(block).offsetBy(
        (i / 9 - 1) * kBlockSize, (i / 3 % 3 - 1) * kBlockSize, (i % 3 - 1) * kBlockSize);
    sources[i].tileRow.fill(accessor.getValue(there));
    sources[i].values = sources[i].tileRow.data();
    sources[i].mask = 0;
  }
  for (int x = -1; x <= kBlockSize + 1; ++x) {
    for (int y = -1; y <= kBlockSize + 1; ++y) {
      const Source<T>* along = &sources[neighbourIndex(x >> 3, y >> 3, -1)];
      const int first = cellIndex(x & 7, y & 7, 0);
      const T* below = along[0].row(first);
      const T* here = along[1].row(first);
      const T* above = along[2].row(first);
      float* to = &values_[index(x, y, -1)];
      to[0] = scaled(below[kBlockSize - 1], isovalue, factor);
      for (int z = 0; z < kBlockSize; ++z) to[z + 1] = scaled(here[z], isovalue, factor);
      to[9] = scaled(above[0], isovalue, factor);
      to[10] = scaled(above[1], isovalue, factor);
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
