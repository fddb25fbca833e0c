#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

#include "base/job.h"
#include "base/parallel_sort.h"

namespace tufa::base {

/// What add(begin, end, list) adds for disjoint ranges that cover [0, count), in parallel, each of
/// at least `grain` indices where there are so many. In rising order; no number may be added twice.
template <class Add>
[[nodiscard]] std::vector<std::uint32_t> collectSorted(Job& job, std::size_t count, const Add& add,
                                                       std::size_t grain = kGrain) {
  std::vector<std::uint32_t> all;
  std::mutex mutex;
  job.forRanges(count, grain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> own;
    add(begin, end, own);
    const std::scoped_lock lock(mutex);
    all.insert(all.end(), own.begin(), own.end());
  });
  parallelSort(all.begin(), all.end(), std::less<>());
  return all;
}

/// The numbers below `count` for which isWanted(number), in rising order. In parallel.
template <class IsWanted>
[[nodiscard]] std::vector<std::uint32_t> collectIf(Job& job, std::size_t count,
                                                   const IsWanted& isWanted,
                                                   std::size_t grain = kGrain) {
  const auto add = [&](std::size_t begin, std::size_t end, std::vector<std::uint32_t>& own) {
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
      if (isWanted(i)) own.push_back(i);
    }
  };
  return collectSorted(job, count, add, grain);
}

}  // namespace tufa::base
