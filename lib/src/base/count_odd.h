#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tufa::base {

/// How many values occur an odd number of times: of the surfaces that a ray crosses, those that its
/// start lies in. Sorts them.
template <class Value>
[[nodiscard]] std::size_t countOdd(std::vector<Value>& values) {
  std::sort(values.begin(), values.end());
  std::size_t odd = 0;
  for (std::size_t first = 0, last = 0; first < values.size(); first = last) {
    while (last < values.size() && values[last] == values[first]) ++last;
    odd += (last - first) % 2;
  }
  return odd;
}

}  // namespace tufa::base
