#pragma once

#include <algorithm>
#include <vector>

namespace tufa::base {

/// Sorts the items and keeps one of equal ones.
template <class T>
void sortUnique(std::vector<T>& items) {
  std::sort(items.begin(), items.end());
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace tufa::base
