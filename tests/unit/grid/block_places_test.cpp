#include "grid/block_places.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "support/print.h"

namespace tufa::grid {
namespace {

constexpr int kNode = BlockPlaces::kNodeVoxels;

// Nodes at some origins, each place of which has a number of its own.
struct Nodes {
  BlockPlaces places;
  std::map<Coord, BlockRef> expected;

  explicit Nodes(const std::vector<Coord>& origins) {
    base::Job job(1, {});
    places.setNodes(origins, job);
    BlockRef number = 0;
    for (std::size_t node = 0; node < origins.size(); ++node) {
      for (int i = 0; i < static_cast<int>(BlockPlaces::kNodePlaces); ++i) {
        places.node(node)[i] = number;
        expected[origins[node] + Coord(i / 256 * 8, i / 16 % 16 * 8, i % 16 * 8)] = number++;
      }
    }
  }
};

TEST(BlockPlaces, FindEachBlockOfTheirNodes) {
  const Nodes nodes({Coord(0), Coord(-kNode, 0, kNode), Coord(0, 0, kNode)});
  ASSERT_EQ(nodes.expected.size(), 3 * BlockPlaces::kNodePlaces);
  for (const auto& [origin, block] : nodes.expected) {
    ASSERT_EQ(nodes.places.find(origin), block) << origin;
  }
}

TEST(BlockPlaces, KnowNothingBeyondTheirNodes) {
  const Nodes nodes({Coord(0)});
  for (const Coord& origin : {Coord(-8, 0, 0), Coord(0, kNode, 0), Coord(0, 0, 32 * kNode)}) {
    EXPECT_EQ(nodes.places.find(origin), BlockPlaces::kUnknown) << origin;
  }
}

TEST(BlockPlaces, TellAllBlocksAroundOneInsideANode) {
  const Nodes nodes({Coord(0), Coord(-kNode, 0, 0)});
  for (const Coord& origin : {Coord(8), Coord(56, 64, 112), Coord(-16, 8, 8)}) {
    std::array<BlockRef, 27> around;
    around.fill(BlockPlaces::kUnknown);
    ASSERT_TRUE(nodes.places.forNear(origin, [&](int i, BlockRef block) { around[i] = block; }));
    for (int i = 0; i < 27; ++i) {
      const Coord at = origin + Coord((i / 9 - 1) * 8, (i / 3 % 3 - 1) * 8, (i % 3 - 1) * 8);
      EXPECT_EQ(around[i], nodes.expected.at(at)) << origin << at;
    }
  }
}

TEST(BlockPlaces, LeaveBlocksAtTheBorderOfANodeToOthers) {
  const Nodes nodes({Coord(0), Coord(-kNode, 0, 0)});
  const auto refuse = [](int, BlockRef) { FAIL(); };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int border : {0, kNode - 8}) {
      Coord origin(56);
      origin[axis] = border;
      EXPECT_FALSE(nodes.places.forNear(origin, refuse)) << origin;
    }
  }
  EXPECT_FALSE(nodes.places.forNear(Coord(8, 8, kNode + 8), refuse)) << "no node";
}

TEST(BlockPlaces, TakeTileBlocksInNodesAndElsewhere) {
  Nodes nodes({Coord(0)});
  const std::vector<Coord> tiles = {Coord(8, 16, 24), Coord(-8, 0, 0), Coord(kNode, 5 * kNode, 0)};
  nodes.places.addTileBlocks(tiles, 90000);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    EXPECT_EQ(nodes.places.find(tiles[i]), 90000 + static_cast<BlockRef>(i));
  }
  EXPECT_EQ(nodes.places.find(Coord(0)), 0) << "others stay";
  EXPECT_EQ(nodes.places.find(Coord(-16, 0, 0)), BlockPlaces::kUnknown);
}

TEST(BlockPlaces, GiveBlocksOtherNumbers) {
  base::Job job(1, {});
  Nodes nodes({Coord(0)});
  nodes.places.addTileBlocks({Coord(kNode, 5 * kNode, 0)}, 4096);
  std::vector<BlockRef> numbers(4097);
  for (BlockRef i = 0; i < 4097; ++i) numbers[i] = i % 2 == 0 ? kMissingBlock : 5000 + i;
  numbers[4096] = 7;
  const BlockRef first = nodes.places.find(Coord(0)), second = nodes.places.find(Coord(0, 0, 8));
  nodes.places.renumber(numbers, job);
  EXPECT_EQ(nodes.places.find(Coord(0)), numbers[first]);
  EXPECT_EQ(nodes.places.find(Coord(0, 0, 8)), numbers[second]);
  EXPECT_EQ(nodes.places.find(Coord(kNode, 5 * kNode, 0)), 7);
  EXPECT_EQ(nodes.places.find(Coord(-16, 0, 0)), BlockPlaces::kUnknown);
}

}  // namespace
}  // namespace tufa::grid
