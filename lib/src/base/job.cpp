#include "base/job.h"

#include <tufa/error.h>
#include <algorithm>
#include <exception>
#include <utility>

namespace tufa::base {

Job::Job(int threads, Progress progress) : threads_(threads), progress_(std::move(progress)) {
  // TBB makes room for as many as it is told.
  constexpr int kMost = 4096;
  if (threads < 0 || threads > kMost) {
    throw Error(ErrorCode::InvalidArgument, "threads is " + std::to_string(threads) +
                                                ", must be 0 (all) to " + std::to_string(kMost));
  }
}

void Job::run(const std::function<void()>& work) { runWithThreads(threads_, work); }

void Job::closeStage() {
  if (times_.empty()) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - stageStart_;
  times_.back().seconds = elapsed.count();
}

void Job::beginStage(std::string name, double endFraction, Length length) {
  closeStage();
  times_.push_back({std::move(name), 0});
  stageStart_ = std::chrono::steady_clock::now();
  stageBegin_ = stageEnd_;
  stageEnd_ = endFraction;
  beginLoop(0, 1);
  length_ = length;
  report(0, 1);
}

std::vector<StageTime> Job::finish() {
  closeStage();
  // Stages that were not needed are done, too.
  stageBegin_ = stageEnd_ = 1;
  length_ = Length::Known;
  report(1, 1);
  return std::exchange(times_, {});
}

void Job::throwIfStopped() {
  if (stopped().load(std::memory_order_relaxed)) {
    throw Error(ErrorCode::Cancelled, "cancelled by the caller");
  }
}

void Job::report(std::size_t done, std::size_t count) {
  const std::string_view stage = times_.empty() ? std::string_view() : times_.back().stage;
  const double inLoop = static_cast<double>(done) / static_cast<double>(count);
  tell(stage, loopBegin_ + (loopEnd_ - loopBegin_) * inLoop);
}

// The share of a stage of unknown length that is likely done: it comes nearer to 1 for ever. Half
// of it once the stage has taken four times as long as all stages before: adaptive meshes of the
// sample volumes took 2 to 30 times as long for their cut as for the uniform mesh.
double Job::shareByTime() const {
  constexpr double kHalfAfter = 4;
  const std::chrono::duration<double> before = stageStart_ - start_;
  const std::chrono::duration<double> inside = std::chrono::steady_clock::now() - stageStart_;
  const double half = kHalfAfter * before.count();
  return inside.count() > 0 ? inside.count() / (inside.count() + half) : 0;
}

// Reports progress. Parts record theirs on the thread they run on; only the caller's thread passes
// the sum on.
void Job::tell(std::string_view stage, double inStage) {
  if (length_ == Length::Unknown) inStage = shareByTime();
  lastFraction_ = std::max(lastFraction_, stageBegin_ + (stageEnd_ - stageBegin_) * inStage);
  if (whole_ != nullptr) {
    share_->store(lastFraction_, std::memory_order_relaxed);
    if (isCaller()) {
      double sum = 0;
      for (const std::atomic<double>& share : *whole_->shares_) {
        sum += share.load(std::memory_order_relaxed);
      }
      whole_->tell(stage, sum / static_cast<double>(whole_->shares_->size()));
    }
  } else if (progress_) {
    bool goOn = true;
    runIsolated([&] { goOn = progress_(stage, lastFraction_); });
    if (!goOn) stopped_ = true;
  }
  throwIfStopped();
}

void Job::checkCancelled(std::size_t done, std::size_t count) {
  isCaller() ? report(done, count) : throwIfStopped();
}

void Job::forRanges(std::size_t count, std::size_t grain, const RangeBody& body) {
  // TBB would make a few large ranges, with no check for cancellation in between.
  constexpr std::size_t kMostRanges = 2048;
  const std::size_t size = std::max(grain, (count + kMostRanges - 1) / kMostRanges);
  std::atomic<std::size_t> done{0};
  runRanges(count, size, [&](std::size_t begin, std::size_t end) {
    if (stopped().load(std::memory_order_relaxed)) return;
    body(begin, end);
    done.fetch_add(end - begin, std::memory_order_relaxed);
    if (isCaller()) report(done, count);
  });
  throwIfStopped();
}

void Job::forParts(std::size_t count,
                   const std::function<void(Job& part, std::size_t index)>& body) {
  Shares shares(count);
  shares_ = &shares;
  std::vector<std::exception_ptr> failures(count);
  runParts(count, [&](std::size_t i) {
    try {
      throwIfStopped();
      Job part(*this, shares[i]);
      body(part, i);
      shares[i] = 1;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::Cancelled) failures[i] = std::current_exception();
      stopped() = true;
    } catch (...) {
      failures[i] = std::current_exception();
      stopped() = true;
    }
  });
  shares_ = nullptr;
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
  throwIfStopped();
}

}  // namespace tufa::base
