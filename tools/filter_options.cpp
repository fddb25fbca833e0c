#include "filter_options.h"

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "console.h"
#include "number.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Declared {
  const char* option;
  const char* help;
};

constexpr std::array<Declared, 9> kDeclared = {{
    {"smooth", "smooth the values: gaussian, mean, median or curvature, with :N for N times"},
    {"offset",
     "move the surface of a level set outward, or inward below 0: in voxels, or with the suffix w "
     "in world units"},
    {"open", "move it inward and back: takes away what is thinner than twice the distance"},
    {"close", "move it outward and back: closes gaps narrower than twice the distance"},
    {"resample", "sample the volume anew with voxels of this size in world units"},
    {"clip",
     "keep what lies in a box, X0,Y0,Z0,X1,Y1,Z1 in world units, or in the active voxels of a grid "
     "of the file"},
    {"keep-largest", "keep so many connected components of the inside, those of the most voxels"},
    {"min-component", "take away components of the inside with fewer voxels"},
    {"mask",
     "keep what lies in a grid of the file: in the inside of a level set, else its active voxels"},
}};

[[noreturn]] void refuse(const FilterWord& word, const std::string& why) {
  throw Error(ErrorCode::InvalidArgument, "--" + word.option + " " + why);
}

/// Reads filters for a grid whose voxels have a size that resampling changes.
class Reader {
 public:
  /// Without a file grids are not read: their filters have none.
  Reader(const std::optional<std::string>& file, double voxelSize)
      : file_(file), voxelSize_(voxelSize) {}

  Filter read(const FilterWord& word) {
    if (word.option == "smooth") return readSmooth(word);
    if (word.option == "offset") return Offset{readDistance(word)};
    if (word.option == "open") return Open{readDistanceAbove0(word)};
    if (word.option == "close") return Close{readDistanceAbove0(word)};
    if (word.option == "resample") return readResample(word);
    if (word.option == "clip") return readClip(word);
    if (word.option == "keep-largest") return KeepLargest{readCount(word)};
    if (word.option == "min-component") return MinComponent{readCount(word)};
    return Mask{readMask(word.value)};
  }

 private:
  static Smooth readSmooth(const FilterWord& word) {
    const std::size_t colon = word.value.find(':');
    const std::string name = word.value.substr(0, colon);
    Smooth smooth;
    if (name == "gaussian") {
      smooth.smoothing = Smoothing::Gaussian;
    } else if (name == "mean") {
      smooth.smoothing = Smoothing::Mean;
    } else if (name == "median") {
      smooth.smoothing = Smoothing::Median;
    } else if (name == "curvature") {
      smooth.smoothing = Smoothing::Curvature;
    } else {
      refuse(word, "is gaussian, mean, median or curvature, not \"" + name + "\"");
    }
    if (colon == std::string::npos) return smooth;
    const auto count = numberIn<int>(std::string_view(word.value).substr(colon + 1));
    if (!count || *count < 1 || *count > 1000) {
      refuse(word, "takes a number of times from 1 to 1000 behind the colon, as in " + name + ":2");
    }
    smooth.iterations = *count;
    return smooth;
  }

  [[nodiscard]] double readDistance(const FilterWord& word) const {
    const auto length = lengthIn(word.value);
    if (!length) refuse(word, "is a number of voxels, or of world units with the suffix w");
    return length->world ? length->value : length->value * voxelSize_;
  }

  [[nodiscard]] double readDistanceAbove0(const FilterWord& word) const {
    const double distance = readDistance(word);
    if (!(distance > 0)) refuse(word, "needs a distance above 0");
    return distance;
  }

  Resample readResample(const FilterWord& word) {
    const auto size = numberIn<double>(word.value);
    if (!size) refuse(word, "is the size of a voxel in world units, not \"" + word.value + "\"");
    requireVoxelSize("--resample", *size);
    voxelSize_ = *size;
    return {*size};
  }

  [[nodiscard]] Filter readClip(const FilterWord& word) const {
    std::vector<double> numbers;
    for (const std::string& part : CLI::detail::split(word.value, ',')) {
      const auto number = numberIn<double>(part);
      if (!number) return ClipGrid{readMask(word.value)};
      numbers.push_back(*number);
    }
    constexpr std::size_t kCorners = 6;
    if (numbers.size() != kCorners) refuse(word, "takes six numbers, X0,Y0,Z0,X1,Y1,Z1, or a grid");
    const ClipBox box{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
    const bool sound = box.least.x < box.greatest.x && box.least.y < box.greatest.y &&
                       box.least.z < box.greatest.z;
    if (!sound) refuse(word, "has a box of which X0, Y0 or Z0 is not below X1, Y1 or Z1");
    return box;
  }

  static std::size_t readCount(const FilterWord& word) {
    const auto count = numberIn<std::size_t>(word.value);
    if (!count || *count == 0) refuse(word, "is a whole number above 0, not " + word.value);
    return *count;
  }

  [[nodiscard]] std::shared_ptr<const openvdb::GridBase> readMask(const std::string& name) const {
    return file_ ? readVolume(*file_, name) : nullptr;
  }

  const std::optional<std::string>& file_;
  double voxelSize_;
};

std::string describeFilter(const FilterWord& word, const FilterReport& report) {
  std::string text = word.option + " " + word.value + ": ";
  if (report.components > 0) {
    text += formatCount(report.componentsKept) + " of " + formatCount(report.components) +
            " components kept, ";
  }
  return text + formatCount(report.voxelsBefore) + " to " + formatCount(report.voxelsAfter) +
         " active voxels, " + shortNumber(report.seconds) + " s\n";
}

}  // namespace

void addFilterOptions(CLI::App& app, FilterWords& words) {
  for (const auto& [option, help] : kDeclared) {
    app.add_option("--" + std::string(option), words.values[option], help)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }
}

void orderFilters(const CLI::App& app, FilterWords& words) {
  std::map<std::string, std::size_t> seen;
  words.inOrder.clear();
  for (const CLI::Option* option : app.parse_order()) {
    if (option->get_lnames().empty()) continue;
    const std::string& name = option->get_lnames().front();
    const auto values = words.values.find(name);
    if (values == words.values.end()) continue;
    words.inOrder.push_back({name, values->second.at(seen[name]++)});
  }
  const std::optional<std::string> noFile;
  Reader reader(noFile, 1);
  for (const FilterWord& word : words.inOrder) static_cast<void>(reader.read(word));
}

std::shared_ptr<openvdb::GridBase> filterVolume(const std::shared_ptr<openvdb::GridBase>& grid,
                                                const std::string& file, const FilterWords& words,
                                                const ContourOptions& meshing, ProgressBar& bar,
                                                FilterRun& run) {
  if (words.inOrder.empty()) return grid;
  FilterOptions options;
  options.isovalue = meshing.isovalue;
  options.inside = meshing.inside;
  options.nonFinite = meshing.nonFinite;
  options.threads = meshing.threads;
  options.progress = bar.callback();
  run.words = words.inOrder;
  std::shared_ptr<openvdb::GridBase> filtered;
  run.seconds = timed([&] {
    const std::optional<std::string> name = file;
    Reader reader(name, voxelSizeOf(*grid));
    std::vector<Filter> filters;
    for (const FilterWord& word : words.inOrder) filters.push_back(reader.read(word));
    filtered = applyFilters(*grid, filters, options, &run.reports);
  });
  return filtered;
}

std::string FilterRun::text() const {
  std::string text;
  for (const FilterWord& word : words) text += " --" + word.option + " " + word.value;
  return text;
}

void requireLeft(const openvdb::GridBase& grid, const std::string& file, const FilterRun& run) {
  const auto hasTakenAll = [](const FilterReport& report) {
    return report.voxelsAfter == 0 || (report.components > 0 && report.componentsKept == 0);
  };
  const auto first = std::find_if(run.reports.begin(), run.reports.end(), hasTakenAll);
  if (first == run.reports.end()) return;
  const FilterWord& word = run.words[static_cast<std::size_t>(first - run.reports.begin())];
  // A box that lies inside a solid meets none of its voxels either.
  const bool isClip = word.option == "clip" && isLevelSet(grid);
  const std::string hint = isClip ? ": the box meets none of the voxels around its surface" : "";
  throw Error(ErrorCode::UnsupportedGrid, "--" + word.option + " " + word.value +
                                              " leaves nothing of grid \"" + nameOf(grid) +
                                              "\" in " + shownInput(file) + hint);
}

Json toJson(const FilterRun& run) {
  Json list = Json::array();
  for (std::size_t i = 0; i < run.reports.size(); ++i) {
    const FilterReport& report = run.reports[i];
    Json json = {{"filter", run.words[i].option},
                 {"value", run.words[i].value},
                 {"voxels_before", report.voxelsBefore},
                 {"voxels_after", report.voxelsAfter}};
    if (report.components > 0) {
      json["components"] = report.components;
      json["components_kept"] = report.componentsKept;
    }
    json["seconds"] = report.seconds;
    list.push_back(std::move(json));
  }
  return list;
}

std::string describe(const FilterRun& run) {
  std::string text;
  for (std::size_t i = 0; i < run.reports.size(); ++i) {
    text += describeFilter(run.words[i], run.reports[i]);
  }
  return text;
}

}  // namespace tufa::tools
