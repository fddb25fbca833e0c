#pragma once

#include <openvdb/openvdb.h>

#include <bit>
#include <cstdint>

// Walks over the tiles of an internal node. A node has 4096 or 32,768 of them, most of no interest,
// and OpenVDB's iterators search the mask of children anew for each.

namespace tufa::grid {

/// Calls visit(position, value) for each tile of an internal node, in the order of positions.
template <class Node, class Visit>
void forTiles(const Node& node, const Visit& visit) {
  constexpr openvdb::Index kWord = 64;
  const auto* const table = node.getTable();
  for (openvdb::Index first = 0; first < Node::NUM_VALUES; first += kWord) {
    const auto children = node.getChildMask().template getWord<std::uint64_t>(first / kWord);
    for (openvdb::Index n = 0; n < kWord; ++n) {
      if ((children >> n & 1) == 0) visit(first + n, table[first + n].getValue());
    }
  }
}

/// How many tiles of an internal node are active.
template <class Node>
std::uint64_t activeTiles(const Node& node) {
  std::uint64_t sum = 0;
  for (openvdb::Index word = 0; word < Node::NUM_VALUES / 64; ++word) {
    sum += static_cast<std::uint64_t>(
        std::popcount(node.getValueMask().template getWord<std::uint64_t>(word) &
                      ~node.getChildMask().template getWord<std::uint64_t>(word)));
  }
  return sum;
}

}  // namespace tufa::grid
