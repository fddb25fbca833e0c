#pragma once

#include <tufa/check.h>
#include <tufa/lod.h>

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "attribute_options.h"
#include "filter_options.h"

namespace tufa::tools {

/// What `tufa lod` was asked for.
struct LodArguments {
  std::string input;
  std::string output;
  std::optional<std::string> format;  ///< of standard output
  std::optional<std::string> grid;
  FilterWords filters;
  AttributeWords attributes;
  LodOptions lod;
  std::optional<std::string> isovalue;
  std::string tolerance = "0.1";
  std::optional<std::string> toleranceGrid;
  std::vector<std::string> tolerances;
  LodWriteOptions writing;
  std::string scenes = "one";
  bool separate = false;
  bool allowEmpty = false;
  std::optional<std::string> report;
  bool check = false;
  bool json = false;
  bool quiet = false;
};

/// What one run found and how long its parts took.
struct LodRun {
  std::string gridName;
  FilterRun filters;
  LodChain chain;
  bool dropping = false;  ///< components may be left out
  ContourReport contour;
  LodWriteReport written;
  std::vector<CheckReport> checks;  ///< empty, or one for each LOD
  double readSeconds = 0;
  double chainSeconds = 0;
  double attributeSeconds = 0;
  double checkSeconds = 0;
  double writeSeconds = 0;
  double reportSeconds = 0;  ///< of the uniform mesh and the page
  Mesh reference;            ///< the uniform mesh, if there is to be a report
};

/// Reads, makes the levels, checks and writes them, and the page.
[[nodiscard]] LodRun makeLods(const LodArguments& arguments);

/// What a run did, for programs.
[[nodiscard]] nlohmann::ordered_json toJson(const LodRun& run, const LodArguments& arguments);

/// The same for people: headings and one row for each LOD. `minAngle`: the angle that was asked
/// for, degrees.
[[nodiscard]] std::vector<std::vector<std::string>> tableOf(const LodRun& run, double minAngle);

/// The same as some lines of text, the last one about what was written.
[[nodiscard]] std::string describe(const LodRun& run, const LodArguments& arguments);

}  // namespace tufa::tools
