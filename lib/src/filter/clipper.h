#pragma once

#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include <atomic>
#include <cstddef>
#include <vector>

#include "base/parallel.h"
#include "filter/clip_places.h"
#include "grid/progress_interrupter.h"

namespace tufa::filter {

/// Clips a grid in place, as OpenVDB's tools::clip() would: what is active, and of a level set what
/// is inside too, stays where it is in `Places`; all else becomes background. Unlike that it needs
/// no mask on the grid's lattice, which of a coarse one would take all memory, and it can be
/// interrupted; and a node that has only tiles keeps them.
template <class GridT, class Places>
class Clipper {
  using Value = typename GridT::ValueType;
  using Root = typename GridT::TreeType::RootNodeType;
  using Upper = typename Root::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Leaf = typename Lower::ChildNodeType;

 public:
  Clipper(GridT& grid, const Places& places, grid::ProgressInterrupter& interrupter)
      : grid_(grid),
        places_(places),
        interrupter_(interrupter),
        background_(grid.background()),
        keepsInside_(grid.getGridClass() == openvdb::GRID_LEVEL_SET) {}

  void run() {
    clipTiles(grid_.tree().root(), places_.reader());
    forNodes<Upper>([&](Upper& node, const auto& places) { clipTiles(node, places); });
    forNodes<Lower>([&](Lower& node, const auto& places) { clipTiles(node, places); });
    forNodes<Leaf>([&](Leaf& leaf, const auto& places) { clipLeaf(leaf, places); });
    if (!interrupter_.cancelled()) openvdb::tools::prune(grid_.tree());
  }

 private:
  template <class Node, class Visit>
  void forNodes(const Visit& visit) {
    constexpr std::size_t kMostAtOnce = 64;
    std::vector<Node*> nodes;
    grid_.tree().getNodes(nodes);
    std::atomic<std::size_t> done{0};
    base::runRanges(nodes.size(), kMostAtOnce, [&](std::size_t begin, std::size_t end) {
      auto&& places = places_.reader();
      for (std::size_t n = begin; n < end; ++n) {
        // Leaves take the time.
        const std::size_t percent = Node::LEVEL == 0 ? 100 * done++ / nodes.size() : 0;
        if (interrupter_.wasInterrupted(static_cast<int>(percent))) return;
        visit(*nodes[n], places);
      }
    });
  }

  [[nodiscard]] bool mayStay(Value value, bool isActive) const {
    return isActive || (keepsInside_ && value < 0);
  }

  /// Tiles that stay in part become nodes, whose own tiles are clipped after.
  template <class Node, class Reader>
  void clipTiles(Node& node, const Reader& places) const {
    using Child = typename Node::ChildNodeType;
    for (auto tile = node.beginValueAll(); tile; ++tile) {
      const openvdb::Coord at = tile.getCoord();
      const Held held = mayStay(*tile, tile.isValueOn())
                            ? places.heldOf(openvdb::CoordBBox::createCube(at, Child::DIM))
                            : Held::None;
      if (held == Held::Part) {
        node.addChild(new Child(at, *tile, tile.isValueOn()));
      } else if (held == Held::None) {
        tile.setValue(background_);
        tile.setValueOff();
      }
    }
  }

  template <class Reader>
  void clipLeaf(Leaf& leaf, const Reader& places) const {
    const Held held = places.heldOf(leaf.getNodeBoundingBox());
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      const bool stays = held != Held::None && mayStay(leaf.getValue(n), leaf.isValueOn(n)) &&
                         (held == Held::All || places.holds(leaf.offsetToGlobalCoord(n)));
      if (!stays) leaf.setValueOff(n, background_);
    }
  }

  GridT& grid_;
  const Places& places_;
  grid::ProgressInterrupter& interrupter_;
  Value background_;
  bool keepsInside_;  ///< of a level set voxels inside are not active
};

}  // namespace tufa::filter
