#include "blocks/blocks.h"

#include <tufa/error.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <sstream>

#include "base/bits.h"
#include "base/huge_pages.h"
#include "blocks/tile_contacts.h"

namespace tufa::blocks {
namespace {

using openvdb::Coord;

// The value v such that "below v" (or "above v") in T means the same as below (above) the isovalue.
template <class T>
T threshold(const IsoChoice& iso) {
  const T rounded = static_cast<T>(iso.isovalue);
  const T infinity = std::numeric_limits<T>::infinity();
  if (iso.insideIsBelow)
    return rounded < iso.isovalue ? std::nextafter(rounded, infinity) : rounded;
  return rounded > iso.isovalue ? std::nextafter(rounded, -infinity) : rounded;
}

// Side bits of 512 samples. Bytes first, then eight bytes to eight bits by one multiplication: the
// compiler vectorizes the first part and the second is short.
template <bool kBelow, class T>
void packSides(const T* values, T limit, BlockBits& bits) {
  constexpr std::uint64_t kGather = 0x0102040810204080u;
  for (int slab = 0; slab < kBlockSize; ++slab) {
    alignas(64) std::array<std::uint8_t, 64> sides;
    const T* from = values + slab * 64;
    for (int i = 0; i < 64; ++i) sides[i] = kBelow ? from[i] < limit : from[i] > limit;
    std::uint64_t word = 0;
    for (int row = 0; row < 8; ++row) {
      std::uint64_t bytes;
      std::memcpy(&bytes, &sides[row * 8], 8);
      word |= ((bytes * kGather) >> 56) << (row * 8);
    }
    bits.slabs[slab] = word;
  }
}

template <class T>
bool allFinite(const T* values) {
  // x * 0 is 0 for finite x and NaN otherwise; NaN stays in a sum.
  std::array<T, 16> sums{};
  for (int i = 0; i < kBlockCells; i += 16) {
    for (int lane = 0; lane < 16; ++lane) sums[lane] += values[i + lane] * T(0);
  }
  T sum = 0;
  for (const T lane : sums) sum += lane;
  return sum == T(0);
}

}  // namespace

template <class TreeT>
Blocks<TreeT>::Blocks(const TreeT& tree, const IsoChoice& iso, NonFinite nonFinite, base::Job& job)
    : tree_(&tree), iso_(iso) {
  std::vector<const Leaf*> leaves;
  tree.getNodes(leaves);
  base::resizeLarge(origins_, leaves.size(), job);
  base::resizeLarge(values_, leaves.size(), job);
  base::resizeLarge(masks_, leaves.size(), job);
  job.forRanges(leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      origins_[i] = leaves[i]->origin();
      masks_[i] = &leaves[i]->getValueMask();
      values_[i] = leaves[i]->buffer().data();
    }
  });
  readSigns(job);
  readTiles();
  if (nonFiniteValues_ > 0 && nonFinite == NonFinite::Refuse) refuseNonFinite();
  places_.build(tree, iso, job);
  addTileBlocks(job);
}

template <class TreeT>
Blocks<TreeT>::Blocks(const Blocks& whole, const openvdb::CoordBBox& box)
    : tree_(whole.tree_), iso_(whole.iso_), part_(true), nonFiniteValues_(whole.nonFiniteValues_) {
  Accessor accessor(*tree_);
  openvdb::CoordBBox around = box;
  around.expand(kBlockSize);
  places_.buildBox(around, [&](const Coord& origin) {
    const BlockRef block = whole.find(origin, accessor);
    if (block < 0) return block;
    if (!box.isInside(origin)) return kMissingBlock;
    origins_.push_back(origin);
    values_.push_back(whole.values_[block]);
    masks_.push_back(whole.masks_[block]);
    inside_.push_back(whole.inside_[block]);
    return static_cast<BlockRef>(origins_.size() - 1);
  });
}

template <class TreeT>
std::uint64_t Blocks<TreeT>::active(BlockRef block, int x) const {
  if (masks_[block] != nullptr) return masks_[block]->template getWord<std::uint64_t>(x);
  return tree_->isValueOn(origins_[block]) ? ~std::uint64_t{0} : 0;
}

template <class TreeT>
void Blocks<TreeT>::readSigns(base::Job& job) {
  base::resizeLarge(inside_, values_.size(), job);
  const Value limit = threshold<Value>(iso_);
  std::mutex mutex;
  std::size_t firstBad = values_.size();
  std::atomic<std::size_t> active{0};
  job.forRanges(values_.size(), 64, [&](std::size_t begin, std::size_t end) {
    std::size_t activeHere = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Value* values = values_[i];
      activeHere += masks_[i]->countOn();
      if (iso_.insideIsBelow) {
        packSides<true>(values, limit, inside_[i]);
      } else {
        packSides<false>(values, limit, inside_[i]);
      }
      if (allFinite(values)) continue;
      const std::scoped_lock lock(mutex);
      for (int cell = 0; cell < kBlockCells; ++cell) {
        if (std::isfinite(values[cell])) continue;
        ++nonFiniteValues_;
        inside_[i].slabs[cell >> 6] &= ~(std::uint64_t{1} << (cell & 63));
        if (i < firstBad) {
          firstBad = i;
          firstNonFinite_ = origins_[i].offsetBy(cell >> 6, (cell >> 3) & 7, cell & 7);
        }
      }
    }
    active += activeHere;
  });
  activeVoxels_ = active;
}

template <class TreeT>
void Blocks<TreeT>::readTiles() {
  if (!std::isfinite(tree_->background())) {
    throw Error(ErrorCode::NonFiniteValues,
                "the grid's background is not a finite number; set a finite background");
  }
  auto tile = tree_->cbeginValueAll();
  tile.setMaxDepth(tile.getLeafDepth() - 1);
  for (; tile; ++tile) {
    if (tile.isValueOn()) activeVoxels_ += tile.getVoxelCount();
    if (std::isfinite(*tile)) continue;
    if (nonFiniteValues_++ == 0) firstNonFinite_ = tile.getCoord();
  }
}

template <class TreeT>
void Blocks<TreeT>::refuseNonFinite() const {
  std::ostringstream message;
  message << "the grid holds " << nonFiniteValues_ << " NaN or infinite "
          << (nonFiniteValues_ == 1 ? "value" : "values") << ", the first at index ("
          << firstNonFinite_[0] << ", " << firstNonFinite_[1] << ", " << firstNonFinite_[2]
          << "); repair the grid or treat them as outside (--nan outside)";
  throw Error(ErrorCode::NonFiniteValues, message.str());
}

template <class TreeT>
BlockRef Blocks<TreeT>::find(const Coord& origin, Accessor& accessor) const {
  const BlockRef block = places_.find(origin);
  if (block != BlockPlaces<TreeT>::kUnknown) return block;
  return isInside(accessor.getValue(origin), iso_) ? kInsideTile : kOutsideTile;
}

template <class TreeT>
Neighbours Blocks<TreeT>::neighbours(BlockRef block, Accessor& accessor) const {
  Neighbours all;
  const Coord& origin = origins_[block];
  if (places_.forNear(origin, [&](int i, BlockRef near) { all[i] = near; })) return all;
  for (int i = 0; i < 27; ++i) {
    all[i] = find(origin.offsetBy((i / 9 - 1) * kBlockSize, (i / 3 % 3 - 1) * kBlockSize,
                                  (i % 3 - 1) * kBlockSize),
                  accessor);
  }
  return all;
}

template <class TreeT>
Neighbours Blocks<TreeT>::upperNeighbours(BlockRef block, Accessor& accessor) const {
  Neighbours upper{};
  if (places_.forNear(origins_[block], [&](int i, BlockRef near) { upper[i] = near; })) {
    return upper;
  }
  upper[neighbourIndex(0, 0, 0)] = block;
  for (int i = 1; i < 8; ++i) {
    const int dx = i >> 2, dy = (i >> 1) & 1, dz = i & 1;
    upper[neighbourIndex(dx, dy, dz)] =
        find(origins_[block].offsetBy(dx * kBlockSize, dy * kBlockSize, dz * kBlockSize), accessor);
  }
  return upper;
}

// A missing block goes on as the one before it ends: there is no surface to be found.
template <class TreeT>
std::uint64_t Blocks<TreeT>::sides(const Neighbours& neighbours, int dx, int dy, int dz,
                                   int x) const {
  constexpr std::uint64_t kFirstZ = 0x0101010101010101u;
  const BlockRef block = neighbours[neighbourIndex(dx, dy, dz)];
  if (block >= 0) return inside_[block].slabs[x];
  if (block != kMissingBlock) return block == kInsideTile ? ~std::uint64_t{0} : 0;
  if (dx != 0) return sides(neighbours, 0, dy, dz, kBlockSize - 1);
  if (dy != 0) return sides(neighbours, 0, 0, dz, x) >> 56;
  return (sides(neighbours, 0, 0, 0, x) >> 7) & kFirstZ;
}

template <class TreeT>
CornerWords Blocks<TreeT>::cornerWords(const Neighbours& neighbours) const {
  const auto slab = [&](int dx, int dy, int dz, int x) { return sides(neighbours, dx, dy, dz, x); };
  CornerWords corners;
  for (int x = 0; x <= kBlockSize; ++x) {
    const int dx = x == kBlockSize ? 1 : 0;
    const int local = x & 7;
    const std::uint64_t here = slab(dx, 0, 0, local);
    const std::uint64_t aboveY = slab(dx, 1, 0, local);
    const std::uint64_t z = stepZ(here, slab(dx, 0, 1, local));
    const std::uint64_t aboveYz = stepZ(aboveY, slab(dx, 1, 1, local));
    corners.words[x] = {here, z, stepY(here, aboveY), stepY(z, aboveYz)};
  }
  return corners;
}

// Where a leaf's first layers differ from a tile below them, that tile's block holds surface cells.
template <class TreeT>
void Blocks<TreeT>::tilesBelowLeaf(BlockRef block, Accessor& accessor,
                                   std::vector<Coord>& found) const {
  constexpr std::uint64_t kFirstY = 0xff;
  constexpr std::uint64_t kFirstZ = 0x0101010101010101u;
  const BlockBits& bits = inside_[block];
  const Neighbours around = neighbours(block, accessor);
  for (int direction = 1; direction < 8; ++direction) {
    const int dx = direction >> 2, dy = (direction >> 1) & 1, dz = direction & 1;
    const Coord below =
        origins_[block].offsetBy(-dx * kBlockSize, -dy * kBlockSize, -dz * kBlockSize);
    const BlockRef tile = around[neighbourIndex(-dx, -dy, -dz)];
    if (tile >= 0) continue;
    const std::uint64_t touching =
        (dy != 0 ? kFirstY : ~std::uint64_t{0}) & (dz != 0 ? kFirstZ : ~std::uint64_t{0});
    const std::uint64_t side = tile == kInsideTile ? ~std::uint64_t{0} : 0;
    std::uint64_t differs = 0;
    for (int x = 0; x < (dx != 0 ? 1 : kBlockSize); ++x) {
      differs |= (bits.slabs[x] ^ side) & touching;
    }
    if (differs != 0) found.push_back(below);
  }
}

template <class TreeT>
void Blocks<TreeT>::addTileBlocks(base::Job& job) {
  std::vector<Coord> tiles = findTileContacts(*tree_, iso_, job);
  std::mutex mutex;
  job.forRanges(origins_.size(), 64, [&](std::size_t begin, std::size_t end) {
    Accessor accessor(*tree_);
    std::vector<Coord> found;
    for (std::size_t i = begin; i < end; ++i) {
      tilesBelowLeaf(static_cast<BlockRef>(i), accessor, found);
    }
    const std::scoped_lock lock(mutex);
    tiles.insert(tiles.end(), found.begin(), found.end());
  });
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  Accessor accessor(*tree_);
  const std::size_t leafCount = origins_.size();
  std::vector<BlockRef> sides;
  for (const Coord& tile : tiles) {
    const BlockRef side = find(tile, accessor);
    if (side >= 0) continue;
    origins_.push_back(tile);
    sides.push_back(side);
  }
  if (origins_.size() == leafCount) return;
  values_.resize(origins_.size(), nullptr);
  masks_.resize(origins_.size(), nullptr);
  inside_.resize(origins_.size());
  for (std::size_t i = leafCount; i < origins_.size(); ++i) {
    inside_[i].slabs.fill(sides[i - leafCount] == kInsideTile ? ~std::uint64_t{0} : 0);
  }
  places_.addTileBlocks({origins_.begin() + static_cast<std::ptrdiff_t>(leafCount), origins_.end()},
                        static_cast<BlockRef>(leafCount));
}

template class Blocks<openvdb::FloatTree>;
template class Blocks<openvdb::DoubleTree>;

}  // namespace tufa::blocks
