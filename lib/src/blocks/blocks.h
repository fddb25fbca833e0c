#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "blocks/block_bits.h"
#include "blocks/block_places.h"
#include "blocks/isovalue.h"

namespace tufa::blocks {

/// A block and the 26 around it: entry (dx + 1) * 9 + (dy + 1) * 3 + dz + 1.
using Neighbours = std::array<BlockRef, 27>;
inline constexpr int neighbourIndex(int dx, int dy, int dz) {
  return (dx + 1) * 9 + (dy + 1) * 3 + dz + 1;
}

/// The grid as blocks of 8^3 cells: every leaf, and every tile region that holds a cell which the
/// surface passes. Keeps pointers into the tree, which must outlive it.
///
/// A block's cell (x, y, z) lies between its lattice points (x..x+1, y..y+1, z..z+1), so the last
/// layer of cells reaches one layer into the blocks above.
template <class TreeT>
class Blocks {
 public:
  using Value = typename TreeT::ValueType;
  using Accessor = openvdb::tree::ValueAccessor<const TreeT>;

  /// Reads the sign of every sample once and finds the blocks. Throws Error(NonFiniteValues) unless
  /// `nonFinite` is Outside.
  Blocks(const TreeT& tree, const IsoChoice& iso, NonFinite nonFinite, base::Job& job);

  /// The blocks of `whole` in a box of whole blocks. The surface ends where others would follow:
  /// the outermost layer of cells is not as it is in `whole`.
  Blocks(const Blocks& whole, const openvdb::CoordBBox& box);

  [[nodiscard]] std::size_t count() const { return origins_.size(); }
  [[nodiscard]] const openvdb::Coord& origin(BlockRef block) const { return origins_[block]; }
  [[nodiscard]] const BlockBits& inside(BlockRef block) const { return inside_[block]; }
  /// The 512 samples of a block, or null where a tile gives them all.
  [[nodiscard]] const Value* values(BlockRef block) const { return values_[block]; }
  /// Slab x of the mask of active samples.
  [[nodiscard]] std::uint64_t active(BlockRef block, int x) const;
  /// The block at these coordinates, or the side of the tile that is there.
  [[nodiscard]] BlockRef find(const openvdb::Coord& origin, Accessor& accessor) const;
  [[nodiscard]] Neighbours neighbours(BlockRef block, Accessor& accessor) const;
  /// The same, with only the block and the seven above it filled in.
  [[nodiscard]] Neighbours upperNeighbours(BlockRef block, Accessor& accessor) const;
  /// Side bits of a block and of the layers above it.
  [[nodiscard]] CornerWords cornerWords(const Neighbours& neighbours) const;
  [[nodiscard]] const TreeT& tree() const { return *tree_; }
  [[nodiscard]] const IsoChoice& iso() const { return iso_; }
  /// Whether blocks may be missing.
  [[nodiscard]] bool isPart() const { return part_; }
  [[nodiscard]] std::size_t nonFiniteValues() const { return nonFiniteValues_; }
  /// Active voxels of the grid, those of tiles included.
  [[nodiscard]] std::size_t activeVoxels() const { return activeVoxels_; }

 private:
  using Leaf = typename TreeT::LeafNodeType;

  [[nodiscard]] std::uint64_t sides(const Neighbours& neighbours, int dx, int dy, int dz,
                                    int x) const;
  void readSigns(base::Job& job);
  void readTiles();
  [[noreturn]] void refuseNonFinite() const;
  void addTileBlocks(base::Job& job);
  void tilesBelowLeaf(BlockRef block, Accessor& accessor, std::vector<openvdb::Coord>& found) const;

  const TreeT* tree_;
  IsoChoice iso_;
  bool part_ = false;
  std::size_t nonFiniteValues_ = 0;
  std::size_t activeVoxels_ = 0;
  openvdb::Coord firstNonFinite_;
  std::vector<openvdb::Coord> origins_;
  std::vector<const Value*> values_;
  std::vector<const typename Leaf::NodeMaskType*> masks_;  ///< null for tiles
  std::vector<BlockBits> inside_;
  BlockPlaces<TreeT> places_;
};

extern template class Blocks<openvdb::FloatTree>;
extern template class Blocks<openvdb::DoubleTree>;

}  // namespace tufa::blocks
