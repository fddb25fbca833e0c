#include "measure.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>

#include "base/peak_memory.h"

namespace tufa::bench {
namespace {

std::optional<double> extraBytesOf(const Contender& contender, int threads) {
  const base::PeakMemory memory;
  (void)contender.run(threads);
  const auto bytes = memory.extraBytes();
  return bytes ? std::optional(static_cast<double>(*bytes)) : std::nullopt;
}

// Processor time of the whole process, in seconds.
double cpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Outcome timedRun(const Contender& contender, int threads, Result& result) {
  const auto start = std::chrono::steady_clock::now();
  const double cpuStart = cpuSeconds();
  Outcome outcome = contender.run(threads);
  result.cpuSeconds.push_back(cpuSeconds() - cpuStart);
  result.seconds.push_back(
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  return outcome;
}

std::vector<StageTime> medianStages(const std::vector<std::vector<StageTime>>& runs) {
  std::vector<StageTime> medians = runs.front();
  for (std::size_t stage = 0; stage < medians.size(); ++stage) {
    std::vector<double> seconds;
    for (const auto& run : runs) seconds.push_back(run.at(stage).seconds);
    medians[stage].seconds = median(std::move(seconds));
  }
  return medians;
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

double medianRatio(const Result& result, const Result& base) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < result.seconds.size(); ++i) {
    ratios.push_back(result.seconds[i] / base.seconds[i]);
  }
  return median(std::move(ratios));
}

std::vector<Result> measure(const std::vector<Contender>& contenders, int threads, int repeats) {
  std::vector<Result> results(contenders.size());
  std::vector<std::vector<std::vector<StageTime>>> stages(contenders.size());
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    results[i].name = contenders[i].name;
    results[i].peer = contenders[i].peer;
    results[i].extraBytes = extraBytesOf(contenders[i], threads);
  }
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      const Outcome outcome = timedRun(contenders[i], threads, results[i]);
      results[i].vertices = outcome.vertices;
      results[i].triangles = outcome.triangles;
      stages[i].push_back(outcome.stages);
    }
  }
  for (std::size_t i = 0; i < contenders.size(); ++i) results[i].stages = medianStages(stages[i]);
  return results;
}

}  // namespace tufa::bench
