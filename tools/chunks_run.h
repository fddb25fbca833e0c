#pragma once

#include <tufa/chunks.h>

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "assemble.h"
#include "attribute_options.h"
#include "filter_options.h"

namespace tufa::tools {

/// What `tufa chunks` was asked for.
struct ChunksArguments {
  std::string input;
  std::string output;
  std::optional<std::string> grid;
  ChunkOptions chunks;
  FilterWords filters;
  AttributeWords attributes;
  std::optional<std::string> isovalue;
  std::string tolerance = "0.1";
  std::string format = "glb";
  std::vector<std::string> only;
  AssembleArguments assemble;
  bool json = false;
  bool quiet = false;
};

/// What one run made and how long its parts took.
struct ChunksRun {
  ChunkIndex index;
  std::vector<Attribute> attributes;  ///< without values
  FilterRun filters;
  ContourReport contour;
  double readSeconds = 0;
  double buildSeconds = 0;
  double attributeSeconds = 0;
  double writeSeconds = 0;
};

/// What a run did, for programs.
[[nodiscard]] nlohmann::ordered_json toJson(const ChunksRun& run, const ChunksArguments& arguments);

/// And for people.
[[nodiscard]] std::string describe(const ChunksRun& run, const ChunksArguments& arguments);

}  // namespace tufa::tools
