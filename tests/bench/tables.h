#pragma once

#include <string>
#include <vector>

#include "measure.h"

namespace tufa::bench {

/// The measurements of one volume at one number of threads.
struct Case {
  std::string volume;
  double activeVoxels = 0;
  int threads = 1;
  std::vector<Result> results;
};

/// A markdown table of the times and the memory of all contenders.
[[nodiscard]] std::string timeTable(const std::vector<Case>& cases);

/// A markdown table of the share of each stage in the time of the contender of that name.
[[nodiscard]] std::string stageTable(const std::vector<Case>& cases, const std::string& name);

}  // namespace tufa::bench
