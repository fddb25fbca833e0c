#include "grid/blocks.h"

#include <limits>
#include <mutex>

#include "base/huge_pages.h"
#include "base/sort_unique.h"
#include "grid/non_finite.h"

namespace tufa::grid {

Blocks::Blocks(std::shared_ptr<const Tree> tree, const IsoChoice& iso, NonFinite nonFinite,
               base::Job& job)
    : tree_(std::move(tree)), iso_(iso) {
  const std::size_t leaves = tree_->leafCount();
  base::resizeLarge(origins_, leaves, job);
  base::resizeLarge(leaves_, leaves, job);
  job.forRanges(leaves, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      leaves_[i] = static_cast<LeafRef>(i);
      origins_[i] = tree_->leafOrigin(leaves_[i]);
    }
  });
  summary_ = tree_->readSides(iso, inside_, job);
  if (summary_.nonFiniteValues > 0 && nonFinite == NonFinite::Refuse) {
    refuseNonFinite(tree_->gridName(), summary_.nonFiniteValues, summary_.firstNonFinite);
  }
  tree_->findPlaces(iso, places_, job);
  addTileBlocks(job);
}

Blocks::Blocks(const Blocks& whole, const Slab& slab, base::Job& job)
    : tree_(whole.tree_),
      iso_(whole.iso_),
      slab_(slab),
      summary_(whole.summary_),
      places_(whole.places_) {
  std::vector<BlockRef> numbers(whole.count(), kMissingBlock);
  for (std::size_t i = 0; i < whole.count(); ++i) {
    job.pollCancelled(i);
    if (!slab.contains(whole.origins_[i])) continue;
    numbers[i] = static_cast<BlockRef>(origins_.size());
    origins_.push_back(whole.origins_[i]);
    leaves_.push_back(whole.leaves_[i]);
    inside_.push_back(whole.inside_[i]);
  }
  places_.renumber(numbers, job);
  if (!tree_->isInMemory()) tree_ = tree_->loadedIn(slab, job);
}

void Blocks::load(base::Job& job) {
  if (tree_->isInMemory()) return;
  using Limits = std::numeric_limits<std::int32_t>;
  tree_ = tree_->loadedIn({0, Limits::min(), Limits::max()}, job);
}

bool Blocks::isInsideOutermost() const {
  return isInside(accessor()->value(Coord(std::numeric_limits<std::int32_t>::max())), iso_);
}

std::uint64_t Blocks::active(BlockRef block, int x, Accessor& accessor) const {
  if (leaves_[block] != kNoLeaf) return tree_->leafActive(leaves_[block], x);
  return accessor.isActive(origins_[block]) ? ~std::uint64_t{0} : 0;
}

BlockRef Blocks::find(const Coord& origin, Accessor& accessor) const {
  const BlockRef block = places_.find(origin);
  if (block != BlockPlaces::kUnknown) return block;
  return isInside(accessor.value(origin), iso_) ? kInsideTile : kOutsideTile;
}

Neighbours Blocks::neighbours(BlockRef block, Accessor& accessor) const {
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

Neighbours Blocks::upperNeighbours(BlockRef block, Accessor& accessor) const {
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

std::uint64_t Blocks::sides(const Neighbours& neighbours, int dx, int dy, int dz, int x) const {
  constexpr std::uint64_t kFirstZ = 0x0101010101010101u;
  const BlockRef block = neighbours[neighbourIndex(dx, dy, dz)];
  if (block >= 0) return inside_[block].slabs[x];
  if (block != kMissingBlock) return block == kInsideTile ? ~std::uint64_t{0} : 0;
  if (slab_->axis == 0) return sides(neighbours, 0, dy, dz, kBlockSize - 1);
  if (slab_->axis == 1) return sides(neighbours, dx, 0, dz, x) >> 56;
  return (sides(neighbours, dx, dy, 0, x) >> 7) & kFirstZ;
}

CornerWords Blocks::cornerWords(const Neighbours& neighbours) const {
  return cornerWordsOf(
      [&](int dx, int dy, int dz, int x) { return sides(neighbours, dx, dy, dz, x); });
}

// Where a leaf's first layers differ from a tile below them, that tile's block holds surface cells.
void Blocks::tilesBelowLeaf(BlockRef block, Accessor& accessor, std::vector<Coord>& found) const {
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

void Blocks::addTileBlocks(base::Job& job) {
  std::vector<Coord> tiles = tree_->tileContacts(iso_, job);
  std::mutex mutex;
  job.forRanges(origins_.size(), 64, [&](std::size_t begin, std::size_t end) {
    const auto accessor = this->accessor();
    std::vector<Coord> found;
    for (std::size_t i = begin; i < end; ++i) {
      tilesBelowLeaf(static_cast<BlockRef>(i), *accessor, found);
    }
    const std::scoped_lock lock(mutex);
    tiles.insert(tiles.end(), found.begin(), found.end());
  });
  base::sortUnique(tiles);
  const auto accessor = this->accessor();
  const std::size_t leafCount = origins_.size();
  std::vector<BlockRef> sides;
  for (const Coord& tile : tiles) {
    const BlockRef side = find(tile, *accessor);
    if (side >= 0) continue;
    origins_.push_back(tile);
    sides.push_back(side);
  }
  if (origins_.size() == leafCount) return;
  leaves_.resize(origins_.size(), kNoLeaf);
  inside_.resize(origins_.size());
  for (std::size_t i = leafCount; i < origins_.size(); ++i) {
    inside_[i].slabs.fill(sides[i - leafCount] == kInsideTile ? ~std::uint64_t{0} : 0);
  }
  places_.addTileBlocks({origins_.begin() + static_cast<std::ptrdiff_t>(leafCount), origins_.end()},
                        static_cast<BlockRef>(leafCount));
}

}  // namespace tufa::grid
