#pragma once

#include <cstddef>
#include <vector>

namespace tufa::base {

/// Asks the system to back the memory at `begin` with large pages: a first touch then costs one
/// page fault for 2 MiB instead of one for 4 KiB. Does nothing where the system knows no such
/// request.
void adviseHugePages(void* begin, std::size_t bytes);

/// Sizes a vector whose elements a parallel loop will write for the first time.
template <class T>
void resizeLarge(std::vector<T>& vector, std::size_t count) {
  vector.reserve(count);
  adviseHugePages(vector.data(), count * sizeof(T));
  vector.resize(count);
}

}  // namespace tufa::base
