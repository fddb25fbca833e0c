#include "grid/tile_surface.h"

#include <atomic>
#include <limits>
#include <optional>
#include <vector>

#include "grid/node_accessor.h"
#include "grid/node_tiles.h"

namespace tufa::grid {
namespace {

/// The origin of the tile beside one of that size, if there are such coordinates.
std::optional<openvdb::Coord> beside(const openvdb::Coord& origin, std::int64_t size, int face) {
  using Limits = std::numeric_limits<std::int32_t>;
  const int axis = face / 2;
  const std::int64_t place = origin[axis] + (face % 2 == 0 ? -size : size);
  if (place < Limits::min() || place > Limits::max()) return std::nullopt;
  openvdb::Coord next = origin;
  next[axis] = static_cast<std::int32_t>(place);
  return next;
}

/// Counts the faces of the tiles on the side that the background is not on: of two tiles of
/// different sides that touch one is such a tile.
template <class TreeT>
class TileFaces {
  using Accessor = NodeAccessor<TreeT>;
  using Upper = typename TreeT::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Leaf = typename Lower::ChildNodeType;

 public:
  TileFaces(const TreeT& tree, const IsoChoice& iso)
      : tree_(tree), iso_(iso), walked_(!isInside(tree.background(), iso)) {}

  std::uint64_t count(base::Job& job) {
    Accessor accessor(tree_);
    for (auto tile = tree_.root().cbeginValueAll(); tile; ++tile) {
      if (isInside(*tile, iso_) == walked_) sum_ += facesOf<Upper>(tile.getCoord(), accessor);
    }
    countIn<Upper>(job);
    countIn<Lower>(job);
    return sum_;
  }

 private:
  template <class Node>
  void countIn(base::Job& job) {
    std::vector<const Node*> nodes;
    tree_.getNodes(nodes);
    job.forRanges(nodes.size(), 4, [&](std::size_t begin, std::size_t end) {
      Accessor accessor(tree_);
      std::uint64_t sum = 0;
      for (std::size_t i = begin; i < end; ++i) {
        forTiles(*nodes[i], [&](openvdb::Index at, auto value) {
          if (isInside(value, iso_) != walked_) return;
          sum += facesOf<typename Node::ChildNodeType>(nodes[i]->offsetToGlobalCoord(at), accessor);
        });
      }
      sum_ += sum;
    });
  }

  /// Of a tile in place of a node.
  template <class Node>
  std::uint64_t facesOf(const openvdb::Coord& origin, Accessor& accessor) const {
    std::uint64_t sum = 0;
    for (int face = 0; face < 6; ++face) {
      if (const auto next = beside(origin, Node::DIM, face)) {
        sum += facesTowards<Node>(*next, face, accessor);
      }
    }
    return sum;
  }

  /// Of a tile towards what lies beyond one of its faces, in a cube as large as the tile: a tile as
  /// large or larger, or the outer layer of a node.
  template <class Node>
  std::uint64_t facesTowards(const openvdb::Coord& cube, int face, Accessor& accessor) const {
    constexpr std::uint64_t kSize = Node::DIM;
    constexpr int kDepth = static_cast<int>(TreeT::DEPTH) - 2 - static_cast<int>(Node::LEVEL);
    if (accessor.getValueDepth(cube) <= kDepth) {
      return isInside(accessor.getValue(cube), iso_) == walked_ ? 0 : kSize * kSize;
    }
    std::uint64_t sum = 0;
    if constexpr (Node::LEVEL > 0) {
      using Child = typename Node::ChildNodeType;
      const int axis = face / 2, second = (axis + 1) % 3, third = (axis + 2) % 3;
      constexpr int kStep = Child::DIM;
      openvdb::Coord part = cube;
      if (face % 2 == 0) part[axis] += static_cast<int>(kSize) - kStep;
      for (int i = 0; i < static_cast<int>(kSize); i += kStep) {
        part[second] = cube[second] + i;
        for (int j = 0; j < static_cast<int>(kSize); j += kStep) {
          part[third] = cube[third] + j;
          sum += facesTowards<Child>(part, face, accessor);
        }
      }
    }
    return sum;
  }

  const TreeT& tree_;
  IsoChoice iso_;
  bool walked_;  ///< side of the tiles to count: inside or not
  std::atomic<std::uint64_t> sum_{0};
};

}  // namespace

template <class TreeT>
std::uint64_t tileSurface(const TreeT& tree, const IsoChoice& iso, base::Job& job) {
  return TileFaces<TreeT>(tree, iso).count(job);
}

template std::uint64_t tileSurface(const openvdb::FloatTree&, const IsoChoice&, base::Job&);
template std::uint64_t tileSurface(const openvdb::DoubleTree&, const IsoChoice&, base::Job&);

}  // namespace tufa::grid
