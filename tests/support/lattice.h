#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <compare>
#include <vector>

#include "grid/blocks.h"
#include "grid/vdb_coord.h"
#include "uniform/cell_topology.h"

namespace tufa::test {

/// A lattice edge upward along an axis.
struct LatticeEdge {
  Coord start;
  int axis = 0;
  friend auto operator<=>(const LatticeEdge&, const LatticeEdge&) = default;
};

/// The crossed edges that start in a window, sample by sample.
template <class TreeT>
std::vector<LatticeEdge> crossedEdgesOf(const TreeT& tree, const grid::IsoChoice& iso,
                                        const openvdb::CoordBBox& window) {
  openvdb::tree::ValueAccessor<const TreeT> accessor(tree);
  const auto inside = [&](const openvdb::Coord& at) {
    return grid::isInside(accessor.getValue(at), iso);
  };
  std::vector<LatticeEdge> edges;
  for (auto at = window.begin(); at; ++at) {
    const bool here = inside(*at);
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Coord end = *at;
      ++end[axis];
      if (inside(end) != here) edges.push_back({grid::fromVdb(*at), axis});
    }
  }
  return edges;
}

/// The crossed edges that start in a window, as the blocks have them.
inline std::vector<LatticeEdge> crossedEdgesOf(const grid::Blocks& blocks,
                                               const openvdb::CoordBBox& window) {
  const auto accessor = blocks.accessor();
  std::vector<LatticeEdge> edges;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const auto block = static_cast<grid::BlockRef>(i);
    const auto corners = blocks.cornerWords(blocks.upperNeighbours(block, *accessor));
    for (int cell = 0; cell < grid::kBlockCells; ++cell) {
      const Coord at = blocks.origin(block).offsetBy(cell >> 6, (cell >> 3) & 7, cell & 7);
      const auto crossed = uniform::crossedEdges(corners, cell >> 6);
      for (int axis = 0; axis < 3; ++axis) {
        if (((crossed[axis] >> (cell & 63)) & 1) == 0) continue;
        if (window.isInside(grid::toVdb(at))) edges.push_back({at, axis});
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace tufa::test
