#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <compare>
#include <vector>

#include "grid/blocks.h"
#include "uniform/cell_topology.h"

namespace tufa::test {

/// A lattice edge upward along an axis.
struct LatticeEdge {
  openvdb::Coord start;
  int axis = 0;
  friend bool operator==(const LatticeEdge&, const LatticeEdge&) = default;
  friend bool operator<(const LatticeEdge& a, const LatticeEdge& b) {
    return a.start != b.start ? a.start < b.start : a.axis < b.axis;
  }
};

inline openvdb::Coord upperEnd(const LatticeEdge& edge) {
  openvdb::Coord end = edge.start;
  ++end[edge.axis];
  return end;
}

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
      const LatticeEdge edge{*at, axis};
      if (inside(upperEnd(edge)) != here) edges.push_back(edge);
    }
  }
  return edges;
}

/// The crossed edges that start in a window, as the blocks have them.
template <class TreeT>
std::vector<LatticeEdge> crossedEdgesOf(const grid::Blocks<TreeT>& blocks,
                                        const openvdb::CoordBBox& window) {
  typename grid::Blocks<TreeT>::Accessor accessor(blocks.tree());
  std::vector<LatticeEdge> edges;
  for (std::size_t i = 0; i < blocks.count(); ++i) {
    const auto block = static_cast<grid::BlockRef>(i);
    const auto corners = blocks.cornerWords(blocks.upperNeighbours(block, accessor));
    for (int cell = 0; cell < grid::kBlockCells; ++cell) {
      const openvdb::Coord at = blocks.origin(block).offsetBy(cell >> 6, (cell >> 3) & 7, cell & 7);
      const auto crossed = uniform::crossedEdges(corners, cell >> 6);
      for (int axis = 0; axis < 3; ++axis) {
        if (((crossed[axis] >> (cell & 63)) & 1) == 0) continue;
        if (window.isInside(at)) edges.push_back({at, axis});
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace tufa::test
