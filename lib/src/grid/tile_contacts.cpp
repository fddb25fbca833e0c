#include "grid/tile_contacts.h"

#include <array>
#include <mutex>

#include "base/sort_unique.h"
#include "grid/block_bits.h"
#include "grid/node_accessor.h"
#include "grid/node_tiles.h"

namespace tufa::grid {
namespace {

// Finds where tiles of different sides touch, over faces, edges or corners. Only tiles on the other
// side than the background are visited: of two touching tiles of different sides one is such a
// tile, and there are finitely many, whereas the background is everywhere. The smallest tiles have
// the size of a leaf, so everything is decided in blocks: a tile of interest is compared with the
// 26 blocks around each of its outer blocks.
template <class TreeT>
class TileContacts {
  using Accessor = NodeAccessor<TreeT>;
  using UpperNode = typename TreeT::RootNodeType::ChildNodeType;
  using LowerNode = typename UpperNode::ChildNodeType;

  static constexpr int kLowerBlocks = 1 << LowerNode::LOG2DIM;    // blocks along a lower node
  static constexpr int kUpperChildren = 1 << UpperNode::LOG2DIM;  // lower nodes along an upper
  static constexpr int kLowerSize = kLowerBlocks * kBlockSize;    // voxels along a lower node
  static constexpr int kLeafDepth = 3;
  static constexpr int kPadded = kLowerBlocks + 2;

  enum class State : signed char { Outside, Inside, Leaf };

 public:
  TileContacts(const TreeT& tree, const IsoChoice& iso)
      : tree_(tree), iso_(iso), walked_(!isInside(tree.background(), iso)) {}

  std::vector<openvdb::Coord> find(base::Job& job) {
    for (auto tile = tree_.root().cbeginValueAll(); tile; ++tile) {
      if (isInside(*tile, iso_) == walked_) collectRootTile(tile.getCoord());
    }
    std::vector<const UpperNode*> uppers;
    std::vector<const LowerNode*> lowers;
    tree_.getNodes(uppers);
    tree_.getNodes(lowers);
    for (const UpperNode* node : uppers) {
      forTiles(*node, [&](openvdb::Index at, auto value) {
        if (isInside(value, iso_) == walked_) bigTiles_.push_back(node->offsetToGlobalCoord(at));
      });
    }
    job.forRanges(bigTiles_.size(), 1, [&](std::size_t begin, std::size_t end) {
      Accessor accessor(tree_);
      std::vector<openvdb::Coord> found;
      for (std::size_t i = begin; i < end; ++i) walkBigTile(bigTiles_[i], accessor, found);
      keep(found);
    });
    job.forRanges(lowers.size(), 4, [&](std::size_t begin, std::size_t end) {
      Accessor accessor(tree_);
      std::vector<openvdb::Coord> found;
      for (std::size_t i = begin; i < end; ++i) walkLowerNode(*lowers[i], accessor, found);
      keep(found);
    });
    base::sortUnique(found_);
    return std::move(found_);
  }

 private:
  void keep(const std::vector<openvdb::Coord>& found) {
    const std::scoped_lock lock(mutex_);
    found_.insert(found_.end(), found.begin(), found.end());
  }

  // Collects the outer parts, of the size of a lower node, of a root tile: the inner ones touch
  // nothing else.
  void collectRootTile(const openvdb::Coord& origin) {
    for (int i = 0; i < kUpperChildren; ++i) {
      for (int j = 0; j < kUpperChildren; ++j) {
        const bool shell = i == 0 || j == 0 || i == kUpperChildren - 1 || j == kUpperChildren - 1;
        for (int k = 0; k < kUpperChildren; k += shell ? 1 : kUpperChildren - 1) {
          bigTiles_.push_back(origin.offsetBy(i * kLowerSize, j * kLowerSize, k * kLowerSize));
        }
      }
    }
  }

  // A sample of a block is a corner of cells in the block itself and in the seven blocks below it.
  static void addWithLowerBlocks(const openvdb::Coord& block, std::vector<openvdb::Coord>& found) {
    for (int corner = 0; corner < 8; ++corner) {
      found.push_back(block.offsetBy(-kBlockSize * (corner >> 2), -kBlockSize * ((corner >> 1) & 1),
                                     -kBlockSize * (corner & 1)));
    }
  }

  State stateAt(const openvdb::Coord& block, Accessor& accessor) const {
    if (accessor.getValueDepth(block) == kLeafDepth) return State::Leaf;
    return isInside(accessor.getValue(block), iso_) ? State::Inside : State::Outside;
  }

  // Compares the outer blocks of a tile as large as a lower node with what lies around it, in each
  // of 26 directions.
  void walkBigTile(const openvdb::Coord& origin, Accessor& accessor,
                   std::vector<openvdb::Coord>& found) const {
    const State other = walked_ ? State::Outside : State::Inside;
    for (int direction = 0; direction < 27; ++direction) {
      const std::array<int, 3> d = {direction / 9 - 1, direction / 3 % 3 - 1, direction % 3 - 1};
      if (direction == 13) continue;
      const openvdb::Coord around =
          origin.offsetBy(d[0] * kLowerSize, d[1] * kLowerSize, d[2] * kLowerSize);
      // A whole tile of the same side as large as this one: the common case inside a solid.
      if (accessor.getValueDepth(around) < kLeafDepth - 1 &&
          isInside(accessor.getValue(around), iso_) == walked_) {
        continue;
      }
      std::array<int, 3> first{}, last{};
      for (int axis = 0; axis < 3; ++axis) {
        first[axis] = d[axis] > 0 ? kLowerBlocks - 1 : 0;
        last[axis] = d[axis] < 0 ? 0 : kLowerBlocks - 1;
      }
      for (int i = first[0]; i <= last[0]; ++i) {
        for (int j = first[1]; j <= last[1]; ++j) {
          for (int k = first[2]; k <= last[2]; ++k) {
            const openvdb::Coord block =
                origin.offsetBy(i * kBlockSize, j * kBlockSize, k * kBlockSize);
            if (touches(block, other, accessor)) addWithLowerBlocks(block, found);
          }
        }
      }
    }
  }

  bool touches(const openvdb::Coord& block, State other, Accessor& accessor) const {
    for (int direction = 0; direction < 27; ++direction) {
      const openvdb::Coord around =
          block.offsetBy((direction / 9 - 1) * kBlockSize, (direction / 3 % 3 - 1) * kBlockSize,
                         (direction % 3 - 1) * kBlockSize);
      if (stateAt(around, accessor) == other) return true;
    }
    return false;
  }

  // Compares a lower node's own tiles with their neighbours. The states of its blocks and of one
  // layer around it are read into an array first, so each is looked up once and not 26 times.
  void walkLowerNode(const LowerNode& node, Accessor& accessor,
                     std::vector<openvdb::Coord>& found) const {
    const State mine = walked_ ? State::Inside : State::Outside;
    const State other = walked_ ? State::Outside : State::Inside;
    const auto at = [](int i, int j, int k) { return (i * kPadded + j) * kPadded + k; };
    std::array<State, kPadded * kPadded * kPadded> states;
    states.fill(State::Leaf);
    bool some = false;
    forTiles(node, [&](openvdb::Index place, auto value) {
      openvdb::Coord local;
      LowerNode::offsetToLocalCoord(place, local);
      const State state = isInside(value, iso_) ? State::Inside : State::Outside;
      states[at(local[0] + 1, local[1] + 1, local[2] + 1)] = state;
      some |= state == mine;
    });
    if (!some) return;
    const auto isPadding = [](int i) { return i == 0 || i == kPadded - 1; };
    for (int i = 0; i < kPadded; ++i) {
      for (int j = 0; j < kPadded; ++j) {
        const bool shell = isPadding(i) || isPadding(j);
        for (int k = 0; k < kPadded; k += shell ? 1 : kPadded - 1) {
          states[at(i, j, k)] = stateAt(blockOf(node, i, j, k), accessor);
        }
      }
    }
    for (int i = 1; i <= kLowerBlocks; ++i) {
      for (int j = 1; j <= kLowerBlocks; ++j) {
        for (int k = 1; k <= kLowerBlocks; ++k) {
          if (states[at(i, j, k)] != mine) continue;
          bool near = false;
          for (int a = i - 1; a <= i + 1; ++a) {
            for (int b = j - 1; b <= j + 1; ++b) {
              for (int c = k - 1; c <= k + 1; ++c) near |= states[at(a, b, c)] == other;
            }
          }
          if (near) addWithLowerBlocks(blockOf(node, i, j, k), found);
        }
      }
    }
  }

  static openvdb::Coord blockOf(const LowerNode& node, int i, int j, int k) {
    return node.origin().offsetBy((i - 1) * kBlockSize, (j - 1) * kBlockSize, (k - 1) * kBlockSize);
  }

  const TreeT& tree_;
  IsoChoice iso_;
  bool walked_;  // side of the tiles to visit: inside or not
  std::vector<openvdb::Coord> bigTiles_;
  std::vector<openvdb::Coord> found_;
  std::mutex mutex_;
};

}  // namespace

template <class TreeT>
std::vector<openvdb::Coord> findTileContacts(const TreeT& tree, const IsoChoice& iso,
                                             base::Job& job) {
  return TileContacts<TreeT>(tree, iso).find(job);
}

template std::vector<openvdb::Coord> findTileContacts(const openvdb::FloatTree&, const IsoChoice&,
                                                      base::Job&);
template std::vector<openvdb::Coord> findTileContacts(const openvdb::DoubleTree&, const IsoChoice&,
                                                      base::Job&);

}  // namespace tufa::grid
