#pragma once

#include <openvdb/util/NullInterrupter.h>
#include <tufa/progress.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <utility>

#include "base/parallel.h"

namespace tufa::grid {

/// Passes OpenVDB's interrupt checks on to a Progress. OpenVDB calls from any thread and gives the
/// percentage only at times, so only the thread that made this passes it on.
class ProgressInterrupter final : public openvdb::util::NullInterrupter {
 public:
  /// The work is of the share from `begin` to `end` of the whole call.
  explicit ProgressInterrupter(const Progress& progress, std::string stage, double begin = 0,
                               double end = 1)
      : progress_(progress), stage_(std::move(stage)), begin_(begin), end_(end) {}

  bool wasInterrupted(int percent = -1) override {
    if (progress_ && !cancelled_ && std::this_thread::get_id() == caller_) {
      fraction_ = std::max(fraction_, std::clamp(percent / 100.0, 0.0, 1.0));
      bool goOn = true;
      base::runIsolated([&] { goOn = progress_(stage_, begin_ + (end_ - begin_) * fraction_); });
      if (!goOn) cancelled_ = true;
    }
    return cancelled_;
  }
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  const Progress& progress_;
  std::string stage_;
  double begin_;
  double end_;
  std::thread::id caller_ = std::this_thread::get_id();
  double fraction_ = 0;
  std::atomic<bool> cancelled_{false};
};

}  // namespace tufa::grid
