#include "blocks/block_places.h"

#include <bit>

#include "base/huge_pages.h"

namespace tufa::blocks {
namespace {

using openvdb::Coord;

std::size_t hashOf(const Coord& origin) {
  const auto mix = [](std::uint64_t hash, std::int32_t value) {
    hash ^= static_cast<std::uint32_t>(value) >> 3;
    hash *= 0x9e3779b97f4a7c15u;
    return hash ^ (hash >> 29);
  };
  return mix(mix(mix(0, origin[0]), origin[1]), origin[2]);
}

}  // namespace

void OriginTable::build(const std::vector<Coord>& origins) {
  const std::size_t size = std::bit_ceil(2 * origins.size() + 2);
  entries_.assign(size, {});
  for (std::size_t i = 0; i < origins.size(); ++i) {
    std::size_t slot = hashOf(origins[i]) & (size - 1);
    while (entries_[slot].number != kNone) slot = (slot + 1) & (size - 1);
    entries_[slot] = {origins[i], static_cast<std::int32_t>(i)};
  }
}

std::int32_t OriginTable::find(const Coord& origin) const {
  std::size_t slot = hashOf(origin) & (entries_.size() - 1);
  while (entries_[slot].number != kNone && entries_[slot].origin != origin) {
    slot = (slot + 1) & (entries_.size() - 1);
  }
  return entries_[slot].number;
}

template <class TreeT>
void BlockPlaces<TreeT>::build(const TreeT& tree, const IsoChoice& iso, base::Job& job) {
  std::vector<const Region*> regions;
  tree.getNodes(regions);
  std::vector<Coord> origins;
  std::vector<BlockRef> firstLeaf;
  BlockRef leaves = 0;
  for (const Region* region : regions) {
    origins.push_back(region->origin());
    firstLeaf.push_back(leaves);
    leaves += static_cast<BlockRef>(region->getChildMask().countOn());
  }
  regionTable_.build(origins);
  looseTable_.build({});
  base::resizeLarge(places_, regions.size() * Region::NUM_VALUES, job);
  job.forRanges(regions.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      BlockRef* places = &places_[i * Region::NUM_VALUES];
      for (auto tile = regions[i]->cbeginValueAll(); tile; ++tile) {
        places[tile.pos()] = isInside(*tile, iso) ? kInsideTile : kOutsideTile;
      }
      BlockRef next = firstLeaf[i];
      for (auto leaf = regions[i]->cbeginChildOn(); leaf; ++leaf) places[leaf.pos()] = next++;
    }
  });
}

template <class TreeT>
void BlockPlaces<TreeT>::buildBox(const openvdb::CoordBBox& box,
                                  const std::function<BlockRef(const Coord&)>& find) {
  box_ = box;
  const openvdb::Coord dim = box.dim();
  places_.resize(static_cast<std::size_t>(dim[0] / kBlockSize) *
                 static_cast<std::size_t>(dim[1] / kBlockSize) *
                 static_cast<std::size_t>(dim[2] / kBlockSize));
  for (int x = box.min()[0]; x <= box.max()[0]; x += kBlockSize) {
    for (int y = box.min()[1]; y <= box.max()[1]; y += kBlockSize) {
      for (int z = box.min()[2]; z <= box.max()[2]; z += kBlockSize) {
        places_[boxIndex({x, y, z})] = find({x, y, z});
      }
    }
  }
}

template <class TreeT>
void BlockPlaces<TreeT>::addTileBlocks(const std::vector<Coord>& origins, BlockRef first) {
  std::vector<Coord> loose;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const BlockRef block = first + static_cast<BlockRef>(i);
    if (const BlockRef* region = regionAt(origins[i])) {
      places_[static_cast<std::size_t>(region - places_.data()) +
              Region::coordToOffset(origins[i])] = block;
    } else {
      loose.push_back(origins[i]);
      looseBlocks_.push_back(block);
    }
  }
  looseTable_.build(loose);
}

template class BlockPlaces<openvdb::FloatTree>;
template class BlockPlaces<openvdb::DoubleTree>;

}  // namespace tufa::blocks
