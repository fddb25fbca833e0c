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

/// Empties a vector and gives its room back, which `vector = {}` does not do.
template <class T>
void release(std::vector<T>& vector) {
  std::vector<T>().swap(vector);
}

}  // namespace tufa::base
