#pragma once

#include <tufa/openvdb_fwd.h>

#include <array>
#include <cstddef>

#include "base/leaf_source.h"
#include "grid/block_bits.h"

namespace tufa::grid {

/// A grid, and what reads the values of its leaves if these are not in memory.
struct StoredGrid {
  const openvdb::GridBase& grid;
  base::LeafSource* leaves = nullptr;

  // NOLINTNEXTLINE(google-explicit-constructor): most grids are in memory
  StoredGrid(const openvdb::GridBase& whole, base::LeafSource* source = nullptr)
      : grid(whole), leaves(source) {}
};

/// Values of one leaf at a time.
template <class LeafT>
class LeafValues {
 public:
  explicit LeafValues(base::LeafSource* source) : source_(source) {}

  /// The values of a leaf with that number in the order of its tree. Valid until the next call.
  const typename LeafT::ValueType* of(const LeafT& leaf, std::size_t number) {
    if (source_ == nullptr) return leaf.buffer().data();
    source_->read(number, values_.data());
    return values_.data();
  }

 private:
  base::LeafSource* source_;
  std::array<typename LeafT::ValueType, kBlockCells> values_;
};

}  // namespace tufa::grid
