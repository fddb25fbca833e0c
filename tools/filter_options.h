#pragma once

#include <tufa/filter.h>

#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tufa::tools {

class ProgressBar;

/// A filter as the command line has it.
struct FilterWord {
  std::string option;  ///< without dashes
  std::string value;
};

/// The filters of a command line, in the order given.
struct FilterWords {
  std::map<std::string, std::vector<std::string>> values;  ///< of each option
  std::vector<FilterWord> inOrder;                         ///< by orderFilters()
};

/// What filters did.
struct FilterRun {
  std::vector<FilterWord> words;
  std::vector<FilterReport> reports;  ///< one for each word
  double seconds = 0;
  /// " --offset 1 --open 2": the filters as they were given; empty without.
  [[nodiscard]] std::string text() const;
  /// NaN and infinite values that were taken as outside before the first one.
  [[nodiscard]] std::size_t nonFiniteValues() const {
    return reports.empty() ? 0 : reports.front().nonFiniteValues;
  }
};

/// Declares the options of filters.
void addFilterOptions(CLI::App& app, FilterWords& words);

/// Puts the filters of a parsed command line in their order, and throws Error(InvalidArgument) for
/// values that no filter can have.
void orderFilters(const CLI::App& app, FilterWords& words);

/// Filters a grid of a file, which may name other grids of it. The isovalue and the inside that
/// components have are those of the options for meshing. One call for the progress bar, or none
/// without filters.
[[nodiscard]] std::shared_ptr<openvdb::GridBase> filterVolume(
    const std::shared_ptr<openvdb::GridBase>& grid, const std::string& file,
    const FilterWords& words, const ContourOptions& meshing, ProgressBar& bar, FilterRun& run);

/// Throws Error(UnsupportedGrid) with the filter that has left nothing of a grid of a file.
void requireLeft(const openvdb::GridBase& grid, const std::string& file, const FilterRun& run);

/// What filters did, for programs.
[[nodiscard]] nlohmann::ordered_json toJson(const FilterRun& run);

/// The same for people: a line for each.
[[nodiscard]] std::string describe(const FilterRun& run);

}  // namespace tufa::tools
