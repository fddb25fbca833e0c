#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/huge_pages.h"
#include "base/job.h"

namespace tufa::base {

/// Numbers in groups.
struct Groups {
  std::vector<std::uint32_t> first;    ///< of each group its first item, and the end of the last
  std::vector<std::uint32_t> members;  ///< of each group in rising order
};

/// The key of a number that is in no group.
inline constexpr std::uint32_t kNoGroup = ~std::uint32_t{0};

/// Groups the numbers below `count` by keyOf(number), the number of a group; those of kNoGroup are
/// in none. place(number, at) is told the place of each within its group. A counting sort in
/// ranges, so that threads write apart. Cost: two passes, and 4 bytes a group and range.
template <class KeyOf, class Place>
Groups groupBy(std::size_t count, std::size_t groups, const KeyOf& keyOf, const Place& place,
               Job& job) {
  constexpr std::size_t kRange = 1 << 17;
  const std::size_t ranges = (count + kRange - 1) / kRange;
  std::vector<std::uint32_t> next(ranges * groups, 0);  // first the numbers of members
  const auto forNumbers = [&](const auto& body) {
    job.forRanges(ranges, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t range = begin; range < end; ++range) {
        std::uint32_t* const own = next.data() + range * groups;
        const std::size_t last = count < (range + 1) * kRange ? count : (range + 1) * kRange;
        for (std::size_t i = range * kRange; i < last; ++i) {
          const std::uint32_t key = keyOf(static_cast<std::uint32_t>(i));
          if (key != kNoGroup) body(static_cast<std::uint32_t>(i), key, own[key]++);
        }
      }
    });
  };
  forNumbers([](std::uint32_t, std::uint32_t, std::uint32_t) {});
  Groups all;
  all.first.resize(groups + 1, 0);
  for (std::size_t g = 0; g < groups; ++g) {
    std::uint32_t at = all.first[g];
    for (std::size_t range = 0; range < ranges; ++range) {
      std::uint32_t& own = next[range * groups + g];
      const std::uint32_t size = own;
      own = at;
      at += size;
    }
    all.first[g + 1] = at;
  }
  resizeLarge(all.members, all.first[groups], job);
  forNumbers([&](std::uint32_t number, std::uint32_t key, std::uint32_t at) {
    all.members[at] = number;
    place(number, at - all.first[key]);
  });
  return all;
}

}  // namespace tufa::base
