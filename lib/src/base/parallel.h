#pragma once

#include <cstddef>
#include <functional>

// With parallel_sort.h the only use of TBB. Memory order: a task sees what its caller wrote before,
// and after the call the caller sees what the tasks wrote.

namespace tufa::base {

/// Indices of one range where there is little to do for each: long enough to be worth a task's
/// start, short enough that a small mesh keeps several threads at work.
inline constexpr std::size_t kGrain = 8192;

using RangeBody = std::function<void(std::size_t begin, std::size_t end)>;

/// Runs `work` on this thread, out of reach of whoever cancels the group of tasks that it is called
/// in: a cancelled group skips the loops started in it without a word, ours and OpenVDB's. Whatever
/// begins loops for a public call, and whatever calls a function of the user's, does it through
/// this.
void runIsolated(const std::function<void()>& work);

/// Runs `work`, isolated, with at most `threads` threads, 0: as many as the caller's arena has.
void runWithThreads(int threads, const std::function<void()>& work);

/// Calls body(begin, end) over disjoint ranges that cover [0, count), in parallel, each of at most
/// `size` indices.
void runRanges(std::size_t count, std::size_t size, const RangeBody& body);

/// Calls body(index) for each index below `count`, each in one go, as many at a time as there are
/// threads. A loop inside a body takes up no other body while it waits. Bodies must not throw:
/// loops in others would end unfinished.
void runParts(std::size_t count, const std::function<void(std::size_t index)>& body);

/// The most threads that loops have here.
[[nodiscard]] std::size_t threadCount();

/// Runs both, in parallel if a thread is free.
void runBoth(const std::function<void()>& first, const std::function<void()>& second);

}  // namespace tufa::base
