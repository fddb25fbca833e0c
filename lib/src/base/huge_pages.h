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

/// Has the system back memory with pages now, which else happens at the first touch of each, one
/// after another. Does nothing where the system knows no such request, or has no memory left.
void populate(void* begin, std::size_t bytes);

/// Reserves room for so many elements, which will be written for the first time one after another.
template <class T>
void reserveLarge(std::vector<T>& vector, std::size_t count) {
  vector.reserve(count);
  adviseHugePages(vector.data(), count * sizeof(T));
}

/// Reserves room for so many elements, which will all be written, in pages that all threads get.
template <class T>
void reservePopulated(std::vector<T>& vector, std::size_t count, Job& job) {
  if (vector.capacity() >= count) return;
  constexpr std::size_t kAtOnce = (std::size_t{4} << 20) / sizeof(T) + 1;
  reserveLarge(vector, count);
  job.forRanges(count / kAtOnce, 1, [&](std::size_t begin, std::size_t end) {
    populate(vector.data() + begin * kAtOnce, (end - begin) * kAtOnce * sizeof(T));
  });
}

/// Sizes a vector whose elements a parallel loop will write for the first time. `values`: those of
/// new ones, or none. Clearing much memory takes long, so it is done in steps with checks for
/// cancellation between them.
template <class T, class... Values>
void resizeLarge(std::vector<T>& vector, std::size_t count, Job& job, const Values&... values) {
  constexpr std::size_t kAtOnce = (std::size_t{4} << 20) / sizeof(T) + 1;
  reservePopulated(vector, count, job);
  while (vector.size() < count) {
    vector.resize(std::min(count, vector.size() + kAtOnce), values...);
    job.checkCancelled(0, 1);
  }
}

/// Makes room for so many elements, those that there are included; these move to the new room.
template <class T>
void growLarge(std::vector<T>& vector, std::size_t count) {
  std::vector<T> larger;
  reserveLarge(larger, count);
  larger.insert(larger.end(), vector.begin(), vector.end());
  vector.swap(larger);
}

/// Copies a vector in parallel. `to` must be empty.
template <class T>
void copyLarge(const std::vector<T>& from, std::vector<T>& to, Job& job) {
  constexpr std::size_t kCopied = 65536;
  resizeLarge(to, from.size(), job);
  job.forRanges(from.size(), kCopied, [&](std::size_t begin, std::size_t end) {
    std::copy(from.begin() + static_cast<std::ptrdiff_t>(begin),
              from.begin() + static_cast<std::ptrdiff_t>(end),
              to.begin() + static_cast<std::ptrdiff_t>(begin));
  });
}

}  // namespace tufa::base
