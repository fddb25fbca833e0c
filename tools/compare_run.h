#pragma once

#include <tufa/compare.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "text_table.h"

namespace tufa::tools {

/// What `tufa compare` was asked for.
struct CompareArguments {
  std::string input;
  std::vector<std::string> outputs;  ///< reports, told apart by their endings
  std::optional<std::string> grid;
  std::optional<std::string> isovalue;
  std::optional<std::string> truth;  ///< a shape
  std::string tolerance = "0.1";
  CompareOptions options;
  bool json = false;
  bool quiet = false;
};

/// What one run found.
struct CompareRun {
  std::string gridName;
  Comparison comparison;
  double seconds = 0;
};

/// What a run found, for programs.
[[nodiscard]] nlohmann::ordered_json toJson(const CompareRun& run,
                                            const CompareArguments& arguments);

/// The same for people: headings and one row for each method.
[[nodiscard]] TableRows tableOf(const Comparison& comparison);

/// A sentence about the grid.
[[nodiscard]] std::string summaryOf(const CompareRun& run, const CompareArguments& arguments);

/// One page of HTML that needs no other file: the table, and for each method a picture and a
/// close-up of the place where the meshes differ most. `progress` is asked between the pictures.
[[nodiscard]] std::string pageOf(const CompareRun& run, const CompareArguments& arguments,
                                 const Progress& progress);

}  // namespace tufa::tools
