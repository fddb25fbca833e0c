#pragma once

#include <optional>
#include <vector>

#include "contenders.h"

namespace tufa::bench {

/// What was measured of one contender.
struct Result {
  std::string name;
  std::size_t peer = 0;  ///< as in Contender
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::vector<double> cpuSeconds;  ///< of all threads, of each repeat
  std::vector<double> seconds;     ///< wall clock of each repeat
  std::optional<double>
      extraBytes;                 ///< most memory beyond what was there before, the result included
  std::vector<StageTime> stages;  ///< medians over the repeats
};

/// The middle value; the mean of the two middle ones of an even number.
[[nodiscard]] double median(std::vector<double> values);

/// Median over the repeats of the ratio of two results' times, repeat by repeat: a drift of the
/// machine's speed touches both.
[[nodiscard]] double medianRatio(const Result& result, const Result& base);

/// Runs the contenders in turn, `repeats` times after one round that is not timed and in which the
/// memory is measured.
[[nodiscard]] std::vector<Result> measure(const std::vector<Contender>& contenders, int threads,
                                          int repeats);

}  // namespace tufa::bench
