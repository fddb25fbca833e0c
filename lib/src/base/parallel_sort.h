#pragma once

#include <tbb/parallel_sort.h>

#include <algorithm>

// On its own, as most files do not need TBB's headers.

namespace tufa::base {

/// Sorts a random access range. No two elements may be equivalent, else their order could depend on
/// the number of threads.
template <class Iterator, class Less>
void parallelSort(Iterator begin, Iterator end, const Less& less) {
#ifdef TUFA_THREAD_SANITIZER
  // ThreadSanitizer would see only the half of TBB's sort that is in headers.
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace tufa::base
