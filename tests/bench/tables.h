#pragma once

#include <string>
#include <vector>

#include "measure.h"

namespace tufa::bench {

/// The measurements of one volume at one number of threads. The first result is Tufa's, the second
/// the one it is compared with, the last the floor.
struct Case {
  std::string volume;
  double activeVoxels = 0;
  int threads = 1;
  std::vector<Result> results;
};

/// Markdown tables: times and memory of all contenders; share of each stage of Tufa's.
[[nodiscard]] std::string timeTable(const std::vector<Case>& cases);
[[nodiscard]] std::string stageTable(const std::vector<Case>& cases);

}  // namespace tufa::bench
