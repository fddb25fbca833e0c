#pragma once

#include <tufa/contour.h>
#include <tufa/progress.h>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/parallel.h"

namespace tufa::base {

/// Whether it is known how much there is to do in a stage.
enum class Length {
  Known,    ///< one loop, whose progress is that of the stage
  Unknown,  ///< loops until something holds: the stage moves on by the time it takes
};

/// One long call: its threads, its progress and its stage times.
///
/// Loops hand out index ranges; bodies write to places of their own only, so that results do not
/// depend on the number of threads.
class Job {
 public:
  /// At most `threads` threads, 0: as many as the caller's arena has. `progress` may be empty.
  Job(int threads, Progress progress);

  /// Runs `work` under the thread limit. Loops started inside it share that limit.
  void run(const std::function<void()>& work);

  /// Ends the stage before and begins one that reaches to `endFraction` of the whole call.
  void beginStage(std::string name, double endFraction, Length length = Length::Known);

  /// In a stage of several loops, before each: which share of the stage's work it is.
  void beginLoop(double from, double to) { loopBegin_ = from, loopEnd_ = to; }

  /// Ends the last stage, tells that the whole call is done and returns the times of all stages.
  std::vector<StageTime> finish();

  /// Calls body(begin, end) over disjoint ranges that cover [0, count), in parallel, each of at
  /// least `grain` indices where there are so many. Throws Error(Cancelled) when asked to stop.
  void forRanges(std::size_t count, std::size_t grain, const RangeBody& body);

  /// The same where there is little to do for each index, as for each vertex.
  void forRanges(std::size_t count, const RangeBody& body) { forRanges(count, kGrain, body); }

  /// Calls body(part, index) for each index below `count`, several at a time. Each has a job of its
  /// own: the progress of all is that of this job's stage, and the times of their stages are not
  /// kept. Throws what a body throws, the first of several; the others are stopped then.
  void forParts(std::size_t count, const std::function<void(Job& part, std::size_t index)>& body);

  /// For long work on one thread, now and then: `done` of `count` parts of the stage are done.
  /// Throws Error(Cancelled) when asked to stop.
  void checkCancelled(std::size_t done, std::size_t count);

  /// For short loops on one thread: checks for cancellation once in many indices, without reporting
  /// progress.
  void pollCancelled(std::size_t index) {
    constexpr std::size_t kBetween = std::size_t{1} << 14;
    if (index % kBetween == 0) checkCancelled(0, 1);
  }

 private:
  using Shares = std::vector<std::atomic<double>>;

  Job(Job& whole, std::atomic<double>& share)
      : threads_(whole.threads_), whole_(&whole), share_(&share), caller_(whole.caller_) {}

  [[nodiscard]] bool isCaller() const { return std::this_thread::get_id() == caller_; }
  [[nodiscard]] std::atomic<bool>& stopped() {
    return whole_ != nullptr ? whole_->stopped() : stopped_;
  }
  void throwIfStopped();
  void report(std::size_t done, std::size_t count);
  [[nodiscard]] double shareByTime() const;
  void tell(std::string_view stage, double inStage);
  void closeStage();

  int threads_;
  Progress progress_;
  std::atomic<bool> stopped_{false};      ///< by the caller, or because a part has failed
  Job* whole_ = nullptr;                  ///< what this is a part of
  std::atomic<double>* share_ = nullptr;  ///< how much of this part is done
  const Shares* shares_ = nullptr;        ///< how much of each of its own parts is done
  std::thread::id caller_ = std::this_thread::get_id();
  std::vector<StageTime> times_;
  std::chrono::steady_clock::time_point stageStart_{};
  Length length_ = Length::Known;  ///< of the stage
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double stageBegin_ = 0;
  double stageEnd_ = 0;
  double loopBegin_ = 0, loopEnd_ = 1;  ///< shares of the stage
  double lastFraction_ = 0;
};

}  // namespace tufa::base
