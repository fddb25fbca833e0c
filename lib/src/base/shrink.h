#pragma once

#include <cstddef>
#include <vector>

#include "base/huge_pages.h"
#include "base/job.h"

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

/// The same for a vector that parallel loops fill again and again.
template <class T>
void shrinkTo(std::vector<T>& vector, std::size_t count, Job& job) {
  if (vector.capacity() < count) release(vector);
  resizeLarge(vector, count, job);
  shrinkTo(vector, count);
}

}  // namespace tufa::base
