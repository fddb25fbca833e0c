#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cstddef>

#ifdef TUFA_THREAD_SANITIZER
extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace tufa::base {
namespace {

#ifdef TUFA_THREAD_SANITIZER

/// One call that runs tasks. ThreadSanitizer does not see into TBB, whose library is built without
/// it; so this file is built without it as well, and this class tells it the order that TBB
/// promises, and no more: two tasks of one call remain unordered.
class HandOver {
 public:
  HandOver() { __tsan_release(&begun_); }
  ~HandOver() { __tsan_acquire(&ended_); }
  HandOver(const HandOver&) = delete;
  HandOver& operator=(const HandOver&) = delete;

  /// One task of the call. To live for as long as it runs, also where it throws.
  class Task {
   public:
    explicit Task(HandOver& call) : call_(call) { __tsan_acquire(&call.begun_); }
    ~Task() { __tsan_release(&call_.ended_); }
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

   private:
    HandOver& call_;
  };

 private:
  char begun_ = 0;
  char ended_ = 0;
};

#else

struct HandOver {
  struct Task {
    explicit Task(const HandOver&) {}
  };
};

#endif

}  // namespace

void runIsolated(const std::function<void()>& work) {
  // Loops inside join this context in place of the caller's. An exception passes through it.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::task_group(context).run_and_wait(work);
}

void runWithThreads(int threads, const std::function<void()>& work) {
  if (threads == 0) {
    runIsolated(work);
    return;
  }
  HandOver call;
  // Of more than the process may have, oneTBB would write to standard error.
  const std::size_t most =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  tbb::task_arena arena(static_cast<int>(std::min(static_cast<std::size_t>(threads), most)));
  arena.execute([&] {
    const HandOver::Task task(call);
    runIsolated(work);
  });
}

void runRanges(std::size_t count, std::size_t size, const RangeBody& body) {
  HandOver call;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, size),
      [&](const tbb::blocked_range<std::size_t>& range) {
        const HandOver::Task task(call);
        body(range.begin(), range.end());
      },
      tbb::simple_partitioner());
}

void runParts(std::size_t count, const std::function<void(std::size_t index)>& body) {
  runRanges(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      tbb::this_task_arena::isolate([&] { body(i); });
    }
  });
}

std::size_t threadCount() {
  return static_cast<std::size_t>(std::max(1, tbb::this_task_arena::max_concurrency()));
}

void runBoth(const std::function<void()>& first, const std::function<void()>& second) {
  HandOver call;
  tbb::parallel_invoke(
      [&] {
        const HandOver::Task task(call);
        first();
      },
      [&] {
        const HandOver::Task task(call);
        second();
      });
}

}  // namespace tufa::base
