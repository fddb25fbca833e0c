#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/job.h"

namespace tufa::checks {

/// The sum of body(begin, end) over consecutive ranges of `grain` elements that cover [0, count),
/// added in their order: the same bits for any number of threads.
template <class Sum, class Body>
Sum sumRanges(base::Job& job, std::size_t count, std::size_t grain, const Body& body) {
  std::vector<Sum> parts((count + grain - 1) / grain);
  job.forRanges(parts.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t part = first; part < last; ++part) {
      parts[part] = body(part * grain, std::min((part + 1) * grain, count));
    }
  });
  Sum sum{};
  for (const Sum& part : parts) sum += part;
  return sum;
}

}  // namespace tufa::checks
