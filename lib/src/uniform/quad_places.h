#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/bits.h"
#include "uniform/block_ranges.h"
#include "uniform/quads.h"

namespace tufa::uniform {

/// The four cells around an edge, counter-clockwise seen from its upper end, as steps down the next
/// axis and the one after it, in cyclic order of the axes.
inline constexpr int kAround[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};

/// A quad and the lattice edge it stands around.
struct QuadPlace {
  std::uint64_t quad;
  std::array<int, 3> start;  ///< the edge's lower end, in the block
  int axis;
  bool upward;  ///< the lower end is inside
};

/// Calls body(place) for each quad of a block, in their order.
template <class Body>
void forQuads(const SurfaceView& context, const SurfaceBlock& block, const Body& body) {
  const grid::CornerWords corners = context.blocks.cornerWords(block.neighbours);
  std::uint64_t quad = block.firstQuad;
  for (int axis = 0; axis < 3; ++axis) {
    for (int x = 0; x < grid::kBlockSize; ++x) {
      const std::uint64_t cut =
          block.special < 0 ? 0 : context.topology.specials[block.special].cut[axis].slabs[x];
      const std::uint64_t inside = corners.words[x][0];
      base::forEachBit(crossedEdges(corners, x)[axis] & ~cut, [&](int bit) {
        body(QuadPlace{quad++, {x, bit >> 3, bit & 7}, axis, ((inside >> bit) & 1) != 0});
      });
    }
  }
}

/// Calls body(place, i) for the quads of one block among some, given in rising order: for the i-th.
template <class Body>
void forQuadsAmong(const SurfaceView& context, const std::vector<std::uint32_t>& quads,
                   const BlockRange& range, const Body& body) {
  std::size_t next = range.begin;
  forQuads(context, context.topology.blocks[range.block], [&](const QuadPlace& place) {
    if (next < range.end && quads[next] == place.quad) body(place, next++);
  });
}

/// Whether one of a quad's vertices lies near or on a crease.
[[nodiscard]] inline bool isNearCrease(const VertexSheets& sheets, const Quad& quad) {
  for (const VertexIndex vertex : quad.vertices) {
    if (sheets.kind(vertex) != VertexSheets::Kind::Smooth) return true;
  }
  return false;
}

}  // namespace tufa::uniform
