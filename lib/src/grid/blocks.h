#pragma once

#include <tufa/contour.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/job.h"
#include "grid/block_bits.h"
#include "grid/block_places.h"
#include "grid/isovalue.h"
#include "grid/slab.h"
#include "grid/tree.h"

namespace tufa::grid {

/// A block and the 26 around it: entry (dx + 1) * 9 + (dy + 1) * 3 + dz + 1.
using Neighbours = std::array<BlockRef, 27>;

/// The grid as blocks of 8^3 cells: every leaf, and every part of a tile of that size that holds a
/// surface cell. Keeps pointers into the tree, which must outlive it.
///
/// A block's cell (x, y, z) lies between its lattice points (x..x+1, y..y+1, z..z+1), so the last
/// layer of cells reaches one layer into the blocks above.
class Blocks {
 public:
  /// Reads the sign of every sample once and finds the blocks. Throws Error(NonFiniteValues) unless
  /// `nonFinite` is Outside.
  Blocks(std::shared_ptr<const Tree> tree, const IsoChoice& iso, NonFinite nonFinite,
         base::Job& job);

  /// The blocks of `whole` in a slab of whole blocks. The surface ends at both ends of the slab:
  /// the outermost layer of cells is not as it is in `whole`.
  Blocks(const Blocks& whole, const Slab& slab, base::Job& job);

  /// Reads the values of leaves that are not in memory yet, which only parts do otherwise.
  void load(base::Job& job);

  [[nodiscard]] std::size_t count() const { return origins_.size(); }
  [[nodiscard]] const Coord& origin(BlockRef block) const { return origins_[block]; }
  [[nodiscard]] const BlockBits& inside(BlockRef block) const { return inside_[block]; }
  /// The leaf with the samples of a block; kNoLeaf where a tile gives them all.
  [[nodiscard]] LeafRef leaf(BlockRef block) const { return leaves_[block]; }
  [[nodiscard]] const Tree& tree() const { return *tree_; }
  /// An accessor for values that lie in no block. For one thread.
  [[nodiscard]] std::unique_ptr<Accessor> accessor() const { return tree_->accessor(); }
  /// Slab x of the mask of active samples.
  [[nodiscard]] std::uint64_t active(BlockRef block, int x, Accessor& accessor) const;
  /// The block at these coordinates, or the side of the tile that is there.
  [[nodiscard]] BlockRef find(const Coord& origin, Accessor& accessor) const;
  [[nodiscard]] Neighbours neighbours(BlockRef block, Accessor& accessor) const;
  /// The same, with only the block and the seven above it filled in.
  [[nodiscard]] Neighbours upperNeighbours(BlockRef block, Accessor& accessor) const;
  /// Side bits of a block and of the layers above it.
  [[nodiscard]] CornerWords cornerWords(const Neighbours& neighbours) const;
  [[nodiscard]] const IsoChoice& iso() const { return iso_; }
  /// Whether blocks may be missing.
  [[nodiscard]] bool isPart() const { return slab_.has_value(); }
  /// The slab that the blocks of a part lie in. What is missing beyond is taken to go on as the
  /// last layer before it, samples and sides alike, so that no surface is found between them.
  [[nodiscard]] const Slab& slab() const { return *slab_; }
  [[nodiscard]] std::size_t nonFiniteValues() const { return summary_.nonFiniteValues; }
  /// Whether what lies beyond all blocks is inside.
  [[nodiscard]] bool isInsideOutermost() const;
  /// Active voxels of the grid, those of tiles included.
  [[nodiscard]] std::size_t activeVoxels() const { return summary_.activeVoxels; }

 private:
  [[nodiscard]] std::uint64_t sides(const Neighbours& neighbours, int dx, int dy, int dz,
                                    int x) const;
  void addTileBlocks(base::Job& job);
  void tilesBelowLeaf(BlockRef block, Accessor& accessor, std::vector<Coord>& found) const;

  std::shared_ptr<const Tree> tree_;
  IsoChoice iso_;
  std::optional<Slab> slab_;  ///< of a part
  Tree::Summary summary_;
  std::vector<Coord> origins_;
  std::vector<LeafRef> leaves_;
  std::vector<BlockBits> inside_;
  BlockPlaces places_;
};

}  // namespace tufa::grid
