#pragma once

#include <cstddef>
#include <vector>

namespace tufa::base {

/// Keeps the first elements of a vector, and gives back the room for the others where it is much.
template <class T>
void shrinkTo(std::vector<T>& vector, std::size_t count) {
  vector.resize(count);
  if (vector.capacity() > 2 * count) vector.shrink_to_fit();
}

}  // namespace tufa::base
