#pragma once

#include <tufa/progress.h>
#include <chrono>
#include <string_view>

namespace tufa::tools {

/// A line on standard error that shows the progress: only if standard error is a terminal, and only
/// from the second second on. Removed at the end.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// For the options of a library call; it also cancels when the user asked to stop. Must not
  /// outlive the bar.
  [[nodiscard]] Progress callback();

 private:
  using Clock = std::chrono::steady_clock;
  void show(std::string_view stage, double fraction);
  void clear();

  bool enabled_;
  bool visible_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_{};
};

}  // namespace tufa::tools
