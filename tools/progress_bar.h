#pragma once

#include <tufa/progress.h>
#include <chrono>
#include <cstddef>
#include <string_view>
#include <vector>

namespace tufa::tools {

/// A line on standard error that shows the progress: only if standard error is a terminal, and only
/// from the second second on. Removed at the end. It never falls, over all calls that it is for.
class ProgressBar {
 public:
  /// `shares` has one number for each call to come: how long it is likely to take, compared with
  /// the others.
  explicit ProgressBar(bool quiet, std::vector<double> shares = {1});
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// For the options of the next library call; it also cancels when the user asked to stop. Must
  /// not outlive the bar.
  [[nodiscard]] Progress callback();

 private:
  using Clock = std::chrono::steady_clock;
  void show(std::string_view stage, double fraction);
  void clear();

  bool enabled_;
  bool visible_ = false;
  std::vector<double> shares_;
  std::size_t call_ = 0;  ///< the next one
  double shown_ = 0;
  RestEstimate rest_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_{};
};

/// How long meshing, checking, writing and filtering take on the sample volumes, compared with each
/// other.
inline constexpr double kContourShare = 30;
inline constexpr double kCheckShare = 3;
inline constexpr double kWriteShare = 0.5;
inline constexpr double kFilterShare = 3;

}  // namespace tufa::tools
