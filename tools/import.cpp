#include <openvdb/openvdb.h>

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/import.h>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "number_list.h"
#include "paths.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"
#include "written_grid.h"

namespace tufa::tools {
namespace {

struct ImportArguments {
  std::vector<std::string> inputs;
  std::string output;
  std::string size;
  std::string type = "u8";
  std::string spacing = "1,1,1";
  std::string origin = "0,0,0";
  RawImport options;
  bool json = false;
  bool quiet = false;
};

int runImport(const ImportArguments& arguments) {
  keepApart(arguments.output);
  requireVolumeOutput(arguments.output);
  std::vector<std::filesystem::path> files(arguments.inputs.begin(), arguments.inputs.end());
  requireDistinct(arguments.output, files);
  RawImport options = arguments.options;
  const auto size = numbersIn<3>("--size", arguments.size);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (size[axis] != std::floor(size[axis]) || !(std::abs(size[axis]) < 1e9)) {
      throw Error(ErrorCode::InvalidArgument, "--size takes whole numbers of voxels");
    }
    options.size[axis] = static_cast<std::int64_t>(size[axis]);
  }
  options.type = *rawTypeByName(arguments.type);
  options.spacing = numbersIn<3>("--spacing", arguments.spacing);
  const auto origin = numbersIn<3>("--origin", arguments.origin);
  options.origin = {origin[0], origin[1], origin[2]};
  std::shared_ptr<openvdb::GridBase> grid;
  const double seconds = timed([&] {
    ProgressBar bar(arguments.quiet);
    options.progress = bar.callback();
    grid = importRaw(files, options);
  });
  WrittenGrid written;
  written.input = arguments.inputs.front();
  written.output = arguments.output;
  written.voxelSize = voxelSizeOf(*grid);
  written.makeSeconds = seconds;
  writeAndTell(openvdb::gridPtrCast<openvdb::FloatGrid>(grid), std::move(written),
               {arguments.json, arguments.quiet});
  return kDone;
}

}  // namespace

void addImportCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<ImportArguments>();
  CLI::App* const command = app.add_subcommand("import", "Convert a raw image stack to a volume");
  RawImport& options = arguments->options;
  command
      ->add_option("IMAGES", arguments->inputs,
                   "one or more files of values, x running fastest, that make up the stack")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "the .vdb file to write, or - for standard output")
      ->required();
  command->add_option("--size", arguments->size, "X,Y,Z: voxels along each axis")->required();
  command->add_option("--type", arguments->type, "of the values")
      ->check(CLI::IsMember({"u8", "u16", "i16", "f32"}))
      ->capture_default_str();
  command->add_flag("--big-endian", options.bigEndian, "the high byte of a value comes first");
  command
      ->add_option("--header", options.headerBytes,
                   "bytes at the beginning of each file to leave out")
      ->capture_default_str();
  command->add_option("--spacing", arguments->spacing, "X,Y,Z: world units between voxels")
      ->capture_default_str();
  command->add_option("--origin", arguments->origin, "X,Y,Z: place of the first voxel")
      ->capture_default_str();
  command->add_option("--threshold", options.threshold,
                      "values up to it are background; default: the least value");
  addThreadsOption(*command, options.threads);
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  command->callback(
      [arguments, &chosen] { chosen = [arguments] { return runImport(*arguments); }; });
}

}  // namespace tufa::tools
