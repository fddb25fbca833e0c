#pragma once

#include <openvdb/util/NullInterrupter.h>
#include <tufa/progress.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <utility>

#include "base/parallel.h"

namespace tufa::grid {

/// Passes OpenVDB's interrupt checks on to a Progress. OpenVDB calls from any thread and gives the
/// percentage only at times, so only the thread that made this passes it on; and it calls for each
/// voxel at some places, so that is only where the percentage has risen or some time has passed.
class ProgressInterrupter final : public openvdb::util::NullInterrupter {
 public:
  /// The work is of the share from `begin` to `end` of the whole call.
  explicit ProgressInterrupter(const Progress& progress, std::string stage, double begin = 0,
                               double end = 1)
      : progress_(progress), stage_(std::move(stage)), begin_(begin), end_(end) {}

  bool wasInterrupted(int percent = -1) override {
    if (progress_ && !cancelled_ && std::this_thread::get_id() == caller_) {
      percent_ = std::max(percent_, std::min(percent, 100));
      if (isDue()) tell();
    }
    return cancelled_;
  }
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool isDue() const {
    constexpr std::chrono::milliseconds kBetween(5);
    return percent_ > toldPercent_ || Clock::now() - toldAt_ >= kBetween;
  }

  void tell() {
    bool goOn = true;
    base::runIsolated([&] { goOn = progress_(stage_, std::lerp(begin_, end_, percent_ / 100.0)); });
    if (!goOn) cancelled_ = true;
    toldPercent_ = percent_;
    toldAt_ = Clock::now();
  }

  const Progress& progress_;
  std::string stage_;
  double begin_;
  double end_;
  std::thread::id caller_ = std::this_thread::get_id();
  int percent_ = 0;
  int toldPercent_ = -1;
  Clock::time_point toldAt_{};
  std::atomic<bool> cancelled_{false};
};

}  // namespace tufa::grid
