#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "base/huge_pages.h"

namespace tufa::base {

/// For each of some items the lowest-numbered item that it is connected with. `forPairs(connect)`
/// calls connect(a, b) for pairs of connected items (union-find).
template <class ForPairs>
[[nodiscard]] std::vector<std::uint32_t> connectedItems(std::size_t count,
                                                        const ForPairs& forPairs) {
  std::vector<std::uint32_t> parents;
  reserveLarge(parents, count);
  parents.resize(count);
  std::iota(parents.begin(), parents.end(), std::uint32_t{0});
  const auto rootOf = [&](std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
  };
  forPairs([&](std::uint32_t first, std::uint32_t second) {
    if (parents[first] == parents[second]) return;
    const std::uint32_t a = rootOf(first), b = rootOf(second);
    parents[std::max(a, b)] = std::min(a, b);
  });
  for (std::uint32_t i = 0; i < count; ++i) parents[i] = rootOf(i);
  return parents;
}

}  // namespace tufa::base
