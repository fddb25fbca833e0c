#pragma once

#include <tufa/coord.h>

#include <cstdint>
#include <vector>

#include "base/coord_table.h"
#include "base/job.h"
#include "grid/block_bits.h"

namespace tufa::grid {

/// Index of a block in Blocks::origins, or, where there is no block, the side that the tile there
/// is on.
using BlockRef = std::int32_t;
inline constexpr BlockRef kOutsideTile = -1;
inline constexpr BlockRef kInsideTile = -2;
/// A block that was left out, where Blocks holds only a part of a grid.
inline constexpr BlockRef kMissingBlock = -4;

/// What is at each place of 8^3 samples. One table for each of OpenVDB's lower internal nodes, 16^3
/// places, so that neighbours are mostly found by a step in the same table.
class BlockPlaces {
 public:
  /// A place in no node of the table, covered by a tile as large as a node or larger.
  static constexpr BlockRef kUnknown = -3;

  static constexpr int kNodeBits = 4;  ///< log2 of the places along a node
  static constexpr std::size_t kNodePlaces = std::size_t{1} << (3 * kNodeBits);
  static constexpr int kNodeVoxels = kBlockSize << kNodeBits;  ///< voxels along a node

  /// Makes room for nodes at these origins. The places of each must then be written.
  void setNodes(const std::vector<Coord>& origins, base::Job& job);
  /// The places of a node, by x, then y, then z.
  [[nodiscard]] BlockRef* node(std::size_t index) { return &places_[index * kNodePlaces]; }

  /// Puts blocks, numbered from `first` on, where there are tiles.
  void addTileBlocks(const std::vector<Coord>& origins, BlockRef first);
  /// Gives each block another number, which may be kMissingBlock.
  void renumber(const std::vector<BlockRef>& numbers, base::Job& job);

  /// The block at these coordinates or the side of the tile; kUnknown where a whole node or more is
  /// one tile.
  [[nodiscard]] BlockRef find(const Coord& origin) const {
    const BlockRef* node = nodeAt(origin);
    if (node != nullptr) return node[placeInNode(origin)];
    const std::uint32_t loose = looseTable_.find(origin);
    return loose == base::CoordTable::kNone ? kUnknown : looseBlocks_[loose];
  }

  /// Calls take(i, block) for the places (dx, dy, dz) = -1..1 steps around a block, i being
  /// (dx + 1) * 9 + (dy + 1) * 3 + dz + 1, if all of them lie in one node; else returns false.
  template <class Take>
  bool forNear(const Coord& origin, const Take& take) const {
    constexpr int kLast = (1 << kNodeBits) - 1;
    for (int axis = 0; axis < 3; ++axis) {
      const int local = (origin[axis] / kBlockSize) & kLast;
      if (local == 0 || local == kLast) return false;
    }
    const BlockRef* node = nodeAt(origin);
    if (node == nullptr) return false;
    const BlockRef* here = node + placeInNode(origin);
    constexpr int kStepX = 1 << (2 * kNodeBits), kStepY = 1 << kNodeBits;
    for (int i = 0; i < 27; ++i) {
      take(i, here[(i / 9 - 1) * kStepX + (i / 3 % 3 - 1) * kStepY + i % 3 - 1]);
    }
    return true;
  }

 private:
  [[nodiscard]] static std::size_t placeInNode(const Coord& origin) {
    constexpr int kMask = kNodeVoxels - 1;
    return static_cast<std::size_t>((((origin[0] & kMask) / kBlockSize) << (2 * kNodeBits)) +
                                    (((origin[1] & kMask) / kBlockSize) << kNodeBits) +
                                    (origin[2] & kMask) / kBlockSize);
  }

  [[nodiscard]] const BlockRef* nodeAt(const Coord& origin) const {
    const std::uint32_t node = nodeTable_.find(origin & ~(kNodeVoxels - 1));
    return node == base::CoordTable::kNone ? nullptr : &places_[node * kNodePlaces];
  }

  base::CoordTable nodeTable_;
  std::vector<BlockRef> places_;  // kNodePlaces for each node
  base::CoordTable looseTable_;   // of the blocks in no node
  std::vector<BlockRef> looseBlocks_;
};

}  // namespace tufa::grid
