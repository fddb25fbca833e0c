#include <tufa/voxelize.h>

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/implicit.h>
#include <tufa/io.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "number_list.h"
#include "paths.h"
#include "progress_bar.h"
#include "scene_input.h"
#include "standard_streams.h"
#include "volume.h"
#include "written_grid.h"

namespace tufa::tools {
namespace {

struct ModelArguments {
  std::string input;
  std::string output;
  std::optional<std::string> bounds;
  std::optional<std::string> at;
  std::optional<double> voxelSize;
  std::optional<double> halfWidth;
  VoxelizeOptions options;
  bool json = false;
  bool quiet = false;
};

std::string shownPoint(const Position& p) {
  return "(" + formatNumber(p.x) + ", " + formatNumber(p.y) + ", " + formatNumber(p.z) + ")";
}

/// What `--at` prints.
int tellPoint(const ModelArguments& arguments) {
  const auto at = numbersIn<3>("--at", *arguments.at);
  const implicit::Scene scene = readSceneInput(arguments.input, arguments.bounds);
  const Position point(at[0], at[1], at[2]);
  const double value = scene.field->value(point);
  const Position gradient = scene.field->gradient(point);
  const Position normal = scene.field->normal(point);
  if (arguments.json) {
    nlohmann::ordered_json json;
    json["file"] = arguments.input;
    json["point"] = at;
    json["inside"] = value < 0;
    json["value"] = value;
    json["gradient"] = {gradient.x, gradient.y, gradient.z};
    json["normal"] = {normal.x, normal.y, normal.z};
    print(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  } else {
    print(std::string(value < 0 ? "inside" : "outside") + ", value " + formatNumber(value) +
          "\ngradient " + shownPoint(gradient) + "\nnormal " + shownPoint(normal) + "\n");
  }
  return kDone;
}

/// Of parts of the surface between samples; empty if there are none.
std::string hiddenNote(const VoxelizeReport& report) {
  const bool found = report.hiddenVoxels > 0;
  const std::size_t count = found ? report.hiddenVoxels : report.undecidedVoxels;
  if (count == 0) return {};
  const char* const holds = !found ? " may hold" : count == 1 ? " holds" : " hold";
  const bool elsewhere = report.hiddenVoxels + report.undecidedVoxels > 1;
  return formatCount(count) + (count == 1 ? " voxel" : " voxels") + holds +
         " parts of the surface that no sample shows, near " + shownPoint(report.firstHidden) +
         (elsewhere ? " and elsewhere" : "") + "; take smaller voxels";
}

/// Throws Error(UnsupportedGrid). `hidden`: of hiddenNote().
[[noreturn]] void refuseEmpty(const ModelArguments& arguments, const implicit::Field& field,
                              double voxelSize, const std::string& hidden) {
  const auto isEmpty = [](const implicit::Box& box) {
    return box.least.x > box.greatest.x || box.least.y > box.greatest.y ||
           box.least.z > box.greatest.z;
  };
  const auto isFinite = [](const implicit::Box& box) {
    const Position& a = box.least;
    const Position& b = box.greatest;
    return std::isfinite(a.x + a.y + a.z) && std::isfinite(b.x + b.y + b.z);
  };
  std::string text = shownInput(arguments.input) + " has no surface ";
  if (!isEmpty(field.extent())) text += "that voxels of " + formatNumber(voxelSize) + " show ";
  text += arguments.bounds ? "within --bounds " + *arguments.bounds : "within its bounds";
  if (arguments.bounds && !isStandard(arguments.input)) {
    const implicit::Box whole = readSceneInput(arguments.input, {}).field->extent();
    if (!isEmpty(whole) && isFinite(whole)) {
      text += "; without them it lies from " + shownPoint(whole.least) + " to " +
              shownPoint(whole.greatest);
    }
  }
  throw Error(ErrorCode::UnsupportedGrid, text + (hidden.empty() ? "" : "; " + hidden));
}

int runModel(const ModelArguments& arguments) {
  if (arguments.at && !arguments.output.empty()) {
    throw Error(ErrorCode::InvalidArgument, "--at only prints: leave out --output");
  }
  if (arguments.at) return tellPoint(arguments);
  if (arguments.output.empty()) {
    throw Error(ErrorCode::InvalidArgument, "--output is required, or --at to look at a point");
  }
  keepApart(arguments.output);
  if (arguments.voxelSize) requireVoxelSize("--voxel", *arguments.voxelSize);
  requireVolumeOutput(arguments.output);
  requireDistinct(arguments.output, {arguments.input});
  const implicit::Scene scene = readSceneInput(arguments.input, arguments.bounds);
  VoxelizeOptions options = arguments.options;
  options.voxelSize =
      arguments.voxelSize.value_or(scene.voxelSize.value_or(voxelSizeFor(*scene.field)));
  options.halfWidth = arguments.halfWidth.value_or(scene.halfWidth.value_or(options.halfWidth));
  VoxelizeReport report;
  openvdb::FloatGrid::Ptr grid;
  const double seconds = timed([&] {
    ProgressBar bar(arguments.quiet);
    options.progress = bar.callback();
    grid = voxelize(*scene.field, options, &report);
  });
  const std::string hidden = hiddenNote(report);
  if (report.activeVoxels == 0) refuseEmpty(arguments, *scene.field, options.voxelSize, hidden);
  if (!hidden.empty()) printNote("note: " + hidden);
  grid->setName(scene.name);
  WrittenGrid written;
  written.input = arguments.input;
  written.scene = {report.samples, report.hiddenVoxels, report.undecidedVoxels};
  written.output = arguments.output;
  written.voxelSize = options.voxelSize;
  written.makeSeconds = seconds;
  writeAndTell(grid, std::move(written), {arguments.json, arguments.quiet});
  return kDone;
}

}  // namespace

void addModelCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<ModelArguments>();
  CLI::App* const model = app.add_subcommand("model", "Convert a scene of formulas to a level set");
  VoxelizeOptions& options = arguments->options;
  model
      ->add_option("SCENE", arguments->input,
                   "a .json file of docs/scenes.md, or - for standard input")
      ->required();
  model->add_option("-o,--output", arguments->output,
                    "the .vdb file to write, or - for standard output");
  model->add_option("--voxel", arguments->voxelSize,
                    "voxel size in the scene's units; default: the scene's, or a hundredth of its "
                    "longest side");
  model->add_option("--half-width", arguments->halfWidth,
                    "half width of the narrow band, in voxels; default: the scene's, or 3");
  model->add_option("--bounds", arguments->bounds,
                    "X0,Y0,Z0,X1,Y1,Z1: the box that the solid is cut by, in place of the scene's");
  model->add_option("--at", arguments->at,
                    "X,Y,Z: print value, gradient and normal at a point, and write nothing");
  model->add_option("--band-voxels", options.bandVoxels, "most voxels of the band")
      ->check(above0())
      ->capture_default_str();
  model->add_flag("--fog", options.fog,
                  "a fog volume: 1 inside, down to 0 on the surface, in place of a level set");
  addThreadsOption(*model, options.threads);
  model->add_flag("--json", arguments->json, "one JSON object on standard output");
  model->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  model->callback([arguments, &chosen] { chosen = [arguments] { return runModel(*arguments); }; });
}

}  // namespace tufa::tools
