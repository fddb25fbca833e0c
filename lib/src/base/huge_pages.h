#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/job.h"

namespace tufa::base {

/// Asks the system to back the memory at `begin` with large pages: a first touch then costs one
/// page fault for 2 MiB instead of one for 4 KiB. Does nothing where the system knows no such
/// request.
void adviseHugePages(void* begin, std::size_t bytes);

/// Reserves room for so many elements, which will be written for the first time one after another.
template <class T>
void reserveLarge(std::vector<T>& vector, std::size_t count) {
  vector.reserve(count);
  adviseHugePages(vector.data(), count * sizeof(T));
}

/// Sizes a vector whose elements a parallel loop will write for the first time. Clearing much
/// memory takes long, so it is done in steps with checks for cancellation between them.
template <class T>
void resizeLarge(std::vector<T>& vector, std::size_t count, Job& job) {
  constexpr std::size_t kAtOnce = (std::size_t{4} << 20) / sizeof(T) + 1;
  reserveLarge(vector, count);
  while (vector.size() < count) {
    vector.resize(std::min(count, vector.size() + kAtOnce));
    job.checkCancelled(0, 1);
  }
}

}  // namespace tufa::base
