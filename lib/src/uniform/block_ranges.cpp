#include "uniform/block_ranges.h"

#include <algorithm>

#include "base/collect.h"
#include "base/sort_unique.h"

namespace tufa::uniform {
namespace {

// `first` is the number of a block's first element. Of blocks with the same one all but the last
// are empty.
std::vector<BlockRange> blocksOf(const CellTopology& topology,
                                 const std::vector<std::uint32_t>& elements,
                                 std::uint64_t SurfaceBlock::*first) {
  std::vector<BlockRange> ranges;
  const auto& blocks = topology.blocks;
  for (std::size_t i = 0; i < elements.size();) {
    const auto after = std::upper_bound(
        blocks.begin(), blocks.end(), elements[i],
        [&](std::uint64_t element, const SurfaceBlock& block) { return element < block.*first; });
    BlockRange range{static_cast<SurfaceBlockIndex>(after - blocks.begin() - 1), i, i};
    while (range.end < elements.size() &&
           (after == blocks.end() || elements[range.end] < *after.*first)) {
      ++range.end;
    }
    i = range.end;
    ranges.push_back(range);
  }
  return ranges;
}

}  // namespace

std::vector<BlockRange> blocksOfVertices(const CellTopology& topology,
                                         const std::vector<VertexIndex>& vertices) {
  return blocksOf(topology, vertices, &SurfaceBlock::firstVertex);
}

std::vector<BlockRange> blocksOfQuads(const CellTopology& topology,
                                      const std::vector<std::uint32_t>& quads) {
  return blocksOf(topology, quads, &SurfaceBlock::firstQuad);
}

std::vector<std::uint32_t> quadsAt(const CellTopology& topology, const Mesh& mesh,
                                   const std::vector<VertexIndex>& vertices,
                                   const std::vector<std::uint8_t>& marks, base::Job& job) {
  // A cell's quads stand around edges that start at corners of the cell: in its block, or in one
  // above it.
  std::vector<SurfaceBlockIndex> blocks;
  for (const BlockRange& range : blocksOfVertices(topology, vertices)) {
    for (int corner = 0; corner < kCorners; ++corner) {
      const SurfaceBlockIndex block = topology.neighbour(topology.blocks[range.block], corner >> 2,
                                                         (corner >> 1) & 1, corner & 1);
      if (block != kNoSurfaceBlock) blocks.push_back(block);
    }
  }
  base::sortUnique(blocks);
  const auto add = [&](std::size_t begin, std::size_t end, std::vector<std::uint32_t>& found) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = topology.blocks[blocks[i]];
      for (std::uint64_t quad = block.firstQuad; quad < block.firstQuad + block.quadCount; ++quad) {
        const auto& v = mesh.quads[quad].vertices;
        if (marks[v[0]] != 0 || marks[v[1]] != 0 || marks[v[2]] != 0 || marks[v[3]] != 0)
          found.push_back(static_cast<std::uint32_t>(quad));
      }
    }
  };
  return base::collectSorted(job, blocks.size(), add, 32);
}

}  // namespace tufa::uniform
