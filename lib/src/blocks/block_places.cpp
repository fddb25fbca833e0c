#include "blocks/block_places.h"

#include "base/huge_pages.h"

namespace tufa::blocks {
namespace {

using openvdb::Coord;

void number(const std::vector<Coord>& origins, base::CoordTable& table) {
  table.reserve(origins.size());
  for (std::uint32_t i = 0; i < origins.size(); ++i) table.tryEmplace(origins[i], i);
}

}  // namespace

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
  number(origins, regionTable_);
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
  number(loose, looseTable_);
}

template class BlockPlaces<openvdb::FloatTree>;
template class BlockPlaces<openvdb::DoubleTree>;

}  // namespace tufa::blocks
