#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "base/coord_table.h"
#include "base/job.h"
#include "blocks/block_bits.h"
#include "blocks/isovalue.h"

namespace tufa::blocks {

/// Names a block among Blocks::origins, or, where there is none, the side that the tile there is
/// on.
using BlockRef = std::int32_t;
inline constexpr BlockRef kOutsideTile = -1;
inline constexpr BlockRef kInsideTile = -2;
/// A block that was left out, where Blocks holds only a part of a grid.
inline constexpr BlockRef kMissingBlock = -4;

/// What is at each place of 8^3 samples. One table for each region of 16^3 places that the tree
/// divides, so that neighbours are mostly found by a step in the same table.
template <class TreeT>
class BlockPlaces {
 public:
  /// A place in a region that holds no block and that no tile of the region covers.
  static constexpr BlockRef kUnknown = -3;

  /// Leaves are numbered in the order of the tree.
  void build(const TreeT& tree, const IsoChoice& iso, base::Job& job);
  /// Blocks in a box alone, each at its place; `find` gives the blocks' numbers, or the sides of
  /// tiles. All else is kUnknown.
  void buildBox(const openvdb::CoordBBox& box,
                const std::function<BlockRef(const openvdb::Coord&)>& find);
  /// Puts blocks, numbered from `first` on, where there are tiles.
  void addTileBlocks(const std::vector<openvdb::Coord>& origins, BlockRef first);

  /// The block at these coordinates or the side of the tile; kUnknown where a whole region or more
  /// is one tile.
  [[nodiscard]] BlockRef find(const openvdb::Coord& origin) const {
    if (!box_.empty()) return box_.isInside(origin) ? places_[boxIndex(origin)] : kUnknown;
    const BlockRef* region = regionAt(origin);
    if (region != nullptr) return region[Region::coordToOffset(origin)];
    const std::uint32_t loose = looseTable_.find(origin);
    return loose == base::CoordTable::kNone ? kUnknown : looseBlocks_[loose];
  }

  /// Calls take(i, block) for the places (dx, dy, dz) = -1..1 steps around a block, i being
  /// (dx + 1) * 9 + (dy + 1) * 3 + dz + 1, if all of them lie in one region; else returns false.
  template <class Take>
  bool forNear(const openvdb::Coord& origin, const Take& take) const {
    if (!box_.empty()) return false;
    constexpr int kLast = (1 << Region::LOG2DIM) - 1;
    for (int axis = 0; axis < 3; ++axis) {
      const int local = (origin[axis] / kBlockSize) & kLast;
      if (local == 0 || local == kLast) return false;
    }
    const BlockRef* region = regionAt(origin);
    if (region == nullptr) return false;
    const BlockRef* here = region + Region::coordToOffset(origin);
    constexpr int kStepX = 1 << (2 * Region::LOG2DIM), kStepY = 1 << Region::LOG2DIM;
    for (int i = 0; i < 27; ++i) {
      take(i, here[(i / 9 - 1) * kStepX + (i / 3 % 3 - 1) * kStepY + i % 3 - 1]);
    }
    return true;
  }

 private:
  using Region = typename TreeT::RootNodeType::ChildNodeType::ChildNodeType;

  [[nodiscard]] const BlockRef* regionAt(const openvdb::Coord& origin) const {
    constexpr int kMask = ~static_cast<int>(Region::DIM - 1);
    const std::uint32_t region =
        regionTable_.find({origin[0] & kMask, origin[1] & kMask, origin[2] & kMask});
    return region == base::CoordTable::kNone
               ? nullptr
               : &places_[static_cast<std::size_t>(region) * Region::NUM_VALUES];
  }

  [[nodiscard]] std::size_t boxIndex(const openvdb::Coord& origin) const {
    const openvdb::Coord dim = box_.dim(), at = origin - box_.min();
    const auto size = [](int voxels) { return static_cast<std::size_t>(voxels / kBlockSize); };
    return (size(at[0]) * size(dim[1]) + size(at[1])) * size(dim[2]) + size(at[2]);
  }

  openvdb::CoordBBox box_;  // if not empty, places_ holds all places in it
  base::CoordTable regionTable_;
  std::vector<BlockRef> places_;  // Region::NUM_VALUES for each region
  base::CoordTable looseTable_;   // of the blocks in no region
  std::vector<BlockRef> looseBlocks_;
};

extern template class BlockPlaces<openvdb::FloatTree>;
extern template class BlockPlaces<openvdb::DoubleTree>;

}  // namespace tufa::blocks
