#include <CLI/CLI.hpp>

#include <tufa/io.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/printable.h"
#include "commands.h"
#include "console.h"
#include "file_list.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct InfoArguments {
  std::vector<std::string> inputs;
  bool json = false;
};

Json numberJson(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json gridJson(const GridInfo& info) {
  Json json;
  json["name"] = info.name;
  json["value_type"] = info.valueType;
  json["class"] = info.gridClass;
  json["transform"] = info.transform;
  json["voxel_size"] = info.voxelSize;
  json["active_voxels"] = info.activeVoxels;
  json["leaves"] = info.leaves;
  json["tiles"] = info.tiles;
  json["memory_bytes"] = info.memoryBytes;
  json["bounds"] = {{"min", info.boundsMin}, {"max", info.boundsMax}};
  json["background"] = info.background;
  json["min_value"] = numberJson(info.minValue);
  json["max_value"] = numberJson(info.maxValue);
  json["non_finite_values"] = info.nonFiniteValues;
  json["meshable"] = info.meshable;
  json["why_not"] = info.meshable ? Json(nullptr) : Json(info.whyNot);
  json["metadata"] = Json::object();
  for (const auto& [name, value] : info.metadata) json["metadata"][name] = value;
  return json;
}

// Values may be as long as their makers like.
std::string shownValue(const std::string& value) {
  constexpr std::size_t kMost = 60;
  if (value.size() <= kMost) return base::printable(value);
  return base::printable(value.substr(0, kMost)) + "... (" + formatCount(value.size()) + " bytes)";
}

std::string describeGrid(const GridInfo& info) {
  const auto triple = [](const auto& v, const auto& format) {
    return format(v[0]) + " " + format(v[1]) + " " + format(v[2]);
  };
  const auto integer = [](int value) { return std::to_string(value); };
  std::string text = shownGrid(info.name) + "\n";
  const auto line = [&text](const char* label, const std::string& value) {
    text += "  " + std::string(label) + value + "\n";
  };
  line("class            ", info.gridClass + " of " + info.valueType);
  line("transform        ", info.transform);
  line("voxel size       ", triple(info.voxelSize, formatNumber));
  line("active voxels    ", formatCount(info.activeVoxels));
  line("leaves, tiles    ", formatCount(info.leaves) + ", " + formatCount(info.tiles));
  line("memory           ", formatCount(info.memoryBytes) + " bytes");
  if (info.activeVoxels > 0) {
    line("bounds           ",
         triple(info.boundsMin, integer) + " to " + triple(info.boundsMax, integer));
  }
  if (info.minValue) {
    line("values           ", formatNumber(*info.minValue) + " to " + formatNumber(*info.maxValue) +
                                  ", background " + formatNumber(info.background));
  }
  line("NaN or infinite  ", formatCount(info.nonFiniteValues));
  line("can be meshed    ", info.meshable ? "yes"
                            : holdsLabels(info) && info.activeVoxels > 0
                                ? "by tufa mesh --labels, label by label: " + info.whyNot
                                : "no: " + info.whyNot);
  for (const auto& [name, value] : info.metadata) {
    line("metadata         ", base::printable(name) + " = " + shownValue(value));
  }
  return text;
}

Json fileJson(const std::string& file, const std::vector<GridInfo>& grids) {
  Json json;
  json["file"] = file;
  json["grids"] = Json::array();
  for (const GridInfo& grid : grids) json["grids"].push_back(gridJson(grid));
  return json;
}

std::string describeFile(const std::string& file, const std::vector<GridInfo>& grids) {
  std::string text = shownInput(file) + ": " + std::to_string(grids.size()) +
                     (grids.size() == 1 ? " grid\n" : " grids\n");
  for (const GridInfo& grid : grids) text += describeGrid(grid);
  return text;
}

int runInfo(const InfoArguments& arguments) {
  FileList files(arguments.inputs, arguments.json);
  files.forEach([&](const std::string& file) {
    const std::vector<GridInfo> grids = describeVolumes(file);
    if (arguments.json) {
      files.add(fileJson(file, grids));
    } else {
      print(describeFile(file, grids));
    }
    return kDone;
  });
  return files.finish();
}

}  // namespace

void addInfoCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<InfoArguments>();
  CLI::App* const info = app.add_subcommand("info", "Say what a .vdb file holds");
  info->add_option("FILE", arguments->inputs, "a .vdb file, or several; - for standard input")
      ->required();
  info->add_flag("--json", arguments->json, "one JSON object on standard output");
  info->callback([arguments, &chosen] { chosen = [arguments] { return runInfo(*arguments); }; });
}

}  // namespace tufa::tools
