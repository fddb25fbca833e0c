#pragma once

#include <tufa/mesh.h>

#include <array>
#include <cstdint>
#include <vector>

#include "base/bits.h"
#include "uniform/cell_topology.h"

namespace tufa::extraction {

/// The crossed edges of one surface block, of each kind that a lattice of edges has. Vertices are
/// numbered by block, kind, then place: from topology alone, before any is placed, so that later
/// stages know where to write, without locks or sorting.
template <int kKinds>
struct BlockEdges {
  std::array<grid::BlockBits, kKinds> crossed{};  ///< by the place that an edge starts at
  std::array<std::array<std::uint16_t, grid::kBlockSize>, kKinds> before{};  ///< before each slab
  std::uint64_t first = 0;  ///< number of the first vertex
  std::uint32_t count = 0;

  /// Counts the edges; to be called once the bits are there.
  void countEdges() {
    for (int kind = 0; kind < kKinds; ++kind) {
      for (int x = 0; x < grid::kBlockSize; ++x) {
        before[kind][x] = static_cast<std::uint16_t>(count);
        count += static_cast<std::uint32_t>(base::countBits(crossed[kind].slabs[x]));
      }
    }
  }

  /// The vertex of a crossed edge.
  [[nodiscard]] VertexIndex at(int kind, int x, int bit) const {
    const std::uint64_t lower = crossed[kind].slabs[x] & base::bitsBelow(bit);
    return static_cast<VertexIndex>(first + before[kind][x] +
                                    static_cast<std::uint32_t>(base::countBits(lower)));
  }
};

/// Calls body(kind, x, bit) for each crossed edge, in the order of their numbers.
template <int kKinds, class Body>
void forEdges(const BlockEdges<kKinds>& edges, const Body& body) {
  for (int kind = 0; kind < kKinds; ++kind) {
    for (int x = 0; x < grid::kBlockSize; ++x) {
      base::forEachBit(edges.crossed[kind].slabs[x], [&](int bit) { body(kind, x, bit); });
    }
  }
}

/// The vertices of all edges that the cells of one block have, those that start in the layer above
/// it included.
///
/// `Lattice` tells the kinds of edges: `kKinds`, and `kReach`, for each kind the steps by which an
/// edge of a cell may start above the cell's own place, a bit for each axis (4, 2, 1).
template <class Lattice>
class EdgeTable {
 public:
  static constexpr int kSize = grid::kBlockSize + 1;
  /// Place of a lattice point, each coordinate 0..8.
  static constexpr int placeOf(int x, int y, int z) { return (x * kSize + y) * kSize + z; }
  /// What to add to the place of a cell for the edge of a kind that starts some steps above it.
  static constexpr int offsetOf(int kind, int dx, int dy, int dz) {
    return kind * kPlaces + placeOf(dx, dy, dz);
  }

  using Edges = BlockEdges<Lattice::kKinds>;

  /// Takes over the numbers that `block` needs; `edges` are those of all surface blocks.
  void fill(const uniform::CellTopology& topology, const uniform::SurfaceBlock& block,
            const std::vector<Edges>& edges) {
    const Edges& own = edges[topology.surfaceBlockOf[block.block]];
    auto next = static_cast<VertexIndex>(own.first);
    forEdges(own, [&](int kind, int x, int bit) {
      vertices_[kind * kPlaces + placeOf(x, bit >> 3, bit & 7)] = next++;
    });
    for (int step = 1; step < uniform::kCorners; ++step) {
      const uniform::SurfaceBlockIndex above =
          topology.neighbour(block, step >> 2, (step >> 1) & 1, step & 1);
      if (above != uniform::kNoSurfaceBlock) fillFrom(edges[above], step);
    }
  }

  /// The vertex at the place of a cell plus an offset.
  [[nodiscard]] VertexIndex operator[](int place) const { return vertices_[place]; }

 private:
  static constexpr int kPlaces = kSize * kSize * kSize;

  // Takes over the first layer, on each axis of `step`, of the block in that direction.
  void fillFrom(const Edges& edges, int step) {
    constexpr std::uint64_t kFirstY = 0xff, kFirstZ = 0x0101010101010101u;
    const int dx = step >> 2, dy = (step >> 1) & 1, dz = step & 1;
    const std::uint64_t layer =
        (dy != 0 ? kFirstY : ~std::uint64_t{0}) & (dz != 0 ? kFirstZ : ~std::uint64_t{0});
    const int moved = placeOf(dx * grid::kBlockSize, dy * grid::kBlockSize, dz * grid::kBlockSize);
    for (int kind = 0; kind < Lattice::kKinds; ++kind) {
      if ((step & ~Lattice::kReach[kind]) != 0) continue;
      for (int x = 0; x < (dx != 0 ? 1 : grid::kBlockSize); ++x) {
        base::forEachBit(edges.crossed[kind].slabs[x] & layer, [&](int bit) {
          vertices_[kind * kPlaces + moved + placeOf(x, bit >> 3, bit & 7)] =
              edges.at(kind, x, bit);
        });
      }
    }
  }

  std::array<VertexIndex, Lattice::kKinds * kPlaces> vertices_{};
};

/// Numbers the vertices of all blocks; returns how many there are.
template <int kKinds>
std::uint64_t numberEdges(std::vector<BlockEdges<kKinds>>& edges, base::Job& job) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    job.pollCancelled(i);
    edges[i].first = count;
    count += edges[i].count;
  }
  return count;
}

}  // namespace tufa::extraction
