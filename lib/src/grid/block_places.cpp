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

void BlockPlaces::renumber(const std::vector<BlockRef>& numbers, base::Job& job) {
  const auto renumberAll = [&](std::vector<BlockRef>& blocks) {
    job.forRanges(blocks.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (blocks[i] >= 0) blocks[i] = numbers[static_cast<std::size_t>(blocks[i])];
      }
    });
  };
  renumberAll(places_), renumberAll(looseBlocks_);
}

}  // namespace tufa::grid
