#include "chunks/slabs/split_into_slabs.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>

#include "base/huge_pages.h"
#include "base/index_box.h"

namespace tufa::chunks {
namespace {

int longestAxis(const grid::Blocks& blocks) {
  base::IndexBox box;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    box.add(blocks.origin(static_cast<grid::BlockRef>(i)));
  }
  const auto lengthOf = [&](int axis) { return std::int64_t{box.max[axis]} - box.min[axis]; };
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (lengthOf(axis) > lengthOf(longest)) longest = axis;
  }
  return longest;
}

std::vector<std::uint32_t> activeVoxelsOf(const grid::Blocks& blocks, base::Job& job) {
  std::vector<std::uint32_t> counts;
  base::resizeLarge(counts, blocks.count(), job);
  job.forRanges(blocks.count(), 64, [&](std::size_t begin, std::size_t end) {
    const auto accessor = blocks.accessor();
    for (std::size_t i = begin; i < end; ++i) {
      for (int x = 0; x < grid::kBlockSize; ++x) {
        counts[i] += static_cast<std::uint32_t>(
            std::popcount(blocks.active(static_cast<grid::BlockRef>(i), x, *accessor)));
      }
    }
  });
  return counts;
}

// Of a chunk size, which is a power of two.
std::int32_t rowOf(std::int32_t sample, int chunkSize) {
  return sample >> std::countr_zero(static_cast<unsigned>(chunkSize));
}

}  // namespace

std::vector<grid::Slab> splitIntoSlabs(const grid::Blocks& blocks, int chunkSize,
                                       std::size_t voxels, int thickness, base::Job& job) {
  if (blocks.count() == 0) return {};
  const int axis = longestAxis(blocks);
  const std::vector<std::uint32_t> counts = activeVoxelsOf(blocks, job);
  std::map<std::int32_t, std::size_t> rows;  // active voxels of each row of chunks that has blocks
  std::size_t total = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    job.pollCancelled(i);
    rows[rowOf(blocks.origin(static_cast<grid::BlockRef>(i))[axis], chunkSize)] += counts[i];
    total += counts[i];
  }
  const std::size_t most = std::max<std::size_t>(1, total / std::max<std::size_t>(1, voxels));
  std::vector<grid::Slab> slabs;
  std::size_t before = 0;
  std::int32_t first = rows.begin()->first;
  const std::int32_t end = rows.rbegin()->first + 1;
  const auto isThick = [&](std::int32_t from, std::int32_t to) {
    return (std::int64_t{to} - from) * chunkSize >= thickness;
  };
  for (auto at = rows.begin(); at != rows.end(); ++at) {
    const std::int32_t row = at->first;
    before += at->second;
    // As near to its share as whole rows allow.
    const auto next = std::next(at);
    const std::size_t half = next == rows.end() ? 0 : next->second / 2;
    const bool isFull = (before + half) * most >= total * (slabs.size() + 1);
    if (!isFull || !isThick(first, row + 1) || !isThick(row + 1, end)) continue;
    slabs.push_back({axis, first, row});
    first = row + 1;
  }
  slabs.push_back({axis, first, end - 1});
  return slabs;
}

grid::Slab samplesOf(const grid::Slab& slab, const std::vector<grid::Slab>& all, int chunkSize,
                     int margin) {
  grid::Slab samples{slab.axis, std::numeric_limits<std::int32_t>::min(),
                     std::numeric_limits<std::int32_t>::max()};
  if (slab.first > all.front().first) samples.first = slab.first * chunkSize - margin;
  if (slab.last < all.back().last) samples.last = (slab.last + 1) * chunkSize - 1 + margin;
  return samples;
}

}  // namespace tufa::chunks
