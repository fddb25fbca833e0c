#include "grid/block_places.h"

#include "base/huge_pages.h"

namespace tufa::grid {
namespace {

void number(const std::vector<Coord>& origins, base::CoordTable& table) {
  table.reserve(origins.size());
  for (std::uint32_t i = 0; i < origins.size(); ++i) table.tryEmplace(origins[i], i);
}

}  // namespace

void BlockPlaces::setNodes(const std::vector<Coord>& origins, base::Job& job) {
  number(origins, nodeTable_);
  base::resizeLarge(places_, origins.size() * kNodePlaces, job);
}

void BlockPlaces::buildBox(const base::IndexBox& box,
                           const std::function<BlockRef(const Coord&)>& find) {
  box_ = box;
  const Coord size = box.size();
  places_.resize(static_cast<std::size_t>(size[0] / kBlockSize) *
                 static_cast<std::size_t>(size[1] / kBlockSize) *
                 static_cast<std::size_t>(size[2] / kBlockSize));
  for (int x = box.min[0]; x <= box.max[0]; x += kBlockSize) {
    for (int y = box.min[1]; y <= box.max[1]; y += kBlockSize) {
      for (int z = box.min[2]; z <= box.max[2]; z += kBlockSize) {
        places_[boxIndex({x, y, z})] = find({x, y, z});
      }
    }
  }
}

void BlockPlaces::addTileBlocks(const std::vector<Coord>& origins, BlockRef first) {
  std::vector<Coord> looseOrigins;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    const BlockRef block = first + static_cast<BlockRef>(i);
    if (const BlockRef* node = nodeAt(origins[i])) {
      places_[static_cast<std::size_t>(node - places_.data()) + placeInNode(origins[i])] = block;
    } else {
      looseOrigins.push_back(origins[i]);
      looseBlocks_.push_back(block);
    }
  }
  number(looseOrigins, looseTable_);
}

}  // namespace tufa::grid
