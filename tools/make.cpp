#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/shapes.h>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "paths.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"
#include "written_grid.h"

namespace tufa::tools {
namespace {

struct MakeArguments {
  std::string shape;
  std::string output;
  ShapeOptions options;
  bool json = false;
  bool quiet = false;
};

/// Throws Error(InvalidArgument) for options that mean nothing to the shape.
void requireMeaning(const CLI::App& app, const std::string& shape) {
  const auto refuse = [&](const char* option, bool isMeant, const char* shapes) {
    if (isMeant || app.count(option) == 0) return;
    throw Error(ErrorCode::InvalidArgument,
                std::string(option) + " is for " + shapes + ", and means nothing to " + shape);
  };
  const bool isBand = shape != "noise" && shape != "fog";
  refuse("--seed", !isBand || shape == "terrain", "terrain, noise and fog");
  refuse("--half-width", isBand, "level sets");
}

int runMake(const MakeArguments& arguments) {
  keepApart(arguments.output);
  requireVoxelSize("--voxel", arguments.options.voxelSize);
  requireVolumeOutput(arguments.output);
  openvdb::FloatGrid::Ptr grid;
  const double seconds = timed([&] {
    ProgressBar bar(arguments.quiet);
    ShapeOptions options = arguments.options;
    options.progress = bar.callback();
    grid = makeShape(*shapeByName(arguments.shape), options);
  });
  WrittenGrid written;
  written.output = arguments.output;
  written.voxelSize = arguments.options.voxelSize;
  written.makeSeconds = seconds;
  writeAndTell(grid, std::move(written), {arguments.json, arguments.quiet});
  return kDone;
}

}  // namespace

void addMakeCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<MakeArguments>();
  CLI::App* const make = app.add_subcommand("make", "Make a demonstration volume");
  ShapeOptions& options = arguments->options;
  make->add_option("SHAPE", arguments->shape, "what to make")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(shapeNames().begin(), shapeNames().end())));
  make->add_option("-o,--output", arguments->output,
                   "the .vdb file to write, or - for standard output")
      ->required();
  make->add_option("--voxel", options.voxelSize, "voxel size; a shape is about 2 units in size")
      ->capture_default_str();
  make->add_option("--half-width", options.halfWidth, "half width of the narrow band, in voxels")
      ->capture_default_str();
  make->add_option("--seed", options.seed, "of terrain, noise and fog")->capture_default_str();
  addThreadsOption(*make, options.threads);
  make->add_flag("--json", arguments->json, "one JSON object on standard output");
  make->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  make->callback([make, arguments, &chosen] {
    chosen = [make, arguments] {
      requireMeaning(*make, arguments->shape);
      return runMake(*arguments);
    };
  });
}

}  // namespace tufa::tools
