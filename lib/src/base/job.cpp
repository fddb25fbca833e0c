#include "base/job.h"

#include <tufa/error.h>
#include <algorithm>
#include <utility>

namespace tufa::base {

Job::Job(int threads, Progress progress) : threads_(threads), progress_(std::move(progress)) {
  if (threads < 0) {
    throw Error(ErrorCode::InvalidArgument,
                "threads is " + std::to_string(threads) + ", must be 0 (all) or more");
  }
}

void Job::run(const std::function<void()>& work) { runWithThreads(threads_, work); }

void Job::closeStage() {
  if (times_.empty()) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - stageStart_;
  times_.back().seconds = elapsed.count();
}

void Job::beginStage(std::string name, double endFraction) {
  closeStage();
  times_.push_back({std::move(name), 0});
  stageStart_ = std::chrono::steady_clock::now();
  stageBegin_ = stageEnd_;
  stageEnd_ = endFraction;
  report(0, 1);
}

std::vector<StageTime> Job::finish() {
  closeStage();
  stageBegin_ = stageEnd_;
  report(1, 1);
  return std::exchange(times_, {});
}

void Job::report(std::size_t done, std::size_t count) {
  if (!progress_) return;
  const double inStage = static_cast<double>(done) / static_cast<double>(count);
  lastFraction_ = std::max(lastFraction_, stageBegin_ + (stageEnd_ - stageBegin_) * inStage);
  const std::string_view stage = times_.empty() ? std::string_view() : times_.back().stage;
  if (!progress_(stage, lastFraction_)) cancelled_ = true;
  if (cancelled_) throw Error(ErrorCode::Cancelled, "cancelled by the caller");
}

void Job::look(std::size_t done, std::size_t count) {
  if (std::this_thread::get_id() == caller_) report(done, count);
}

void Job::forRanges(std::size_t count, std::size_t grain, const RangeBody& body) {
  // TBB would hand out a few large ranges, and nobody would ask in between whether to stop.
  constexpr std::size_t kMostRanges = 2048;
  const std::size_t size = std::max(grain, (count + kMostRanges - 1) / kMostRanges);
  std::atomic<std::size_t> done{0};
  runRanges(count, size, [&](std::size_t begin, std::size_t end) {
    if (cancelled_.load(std::memory_order_relaxed)) return;
    body(begin, end);
    done.fetch_add(end - begin, std::memory_order_relaxed);
    if (std::this_thread::get_id() == caller_) report(done, count);
  });
}

}  // namespace tufa::base
