#pragma once

#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <utility>

namespace tufa::base {

/// Sorts a random access range. No two elements may be equivalent, else their order could depend on
/// the number of threads.
template <class Iterator, class Less>
void parallelSort(Iterator begin, Iterator end, const Less& less) {
  tbb::parallel_sort(begin, end, less);
}

/// Runs both, at the same time where there is a thread to spare.
template <class First, class Second>
void runBoth(First&& first, Second&& second) {
  tbb::parallel_invoke(std::forward<First>(first), std::forward<Second>(second));
}

}  // namespace tufa::base
