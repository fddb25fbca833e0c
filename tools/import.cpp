#include <openvdb/openvdb.h>

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/import.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "image_reader.h"
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
  std::optional<std::string> size;
  std::optional<std::string> series;
  std::string type = "u8";
  std::optional<std::string> spacing;
  std::optional<std::string> origin;
  RawImport options;
  bool json = false;
  bool quiet = false;
};

using Files = std::vector<std::filesystem::path>;

std::array<double, 3> readSpacing(const std::string& text) {
  const auto spacing = numbersIn<3>("--spacing", text);
  if (std::any_of(spacing.begin(), spacing.end(), [](double length) { return !(length > 0); })) {
    throw Error(ErrorCode::InvalidArgument, "--spacing takes lengths above 0, not " + text);
  }
  return spacing;
}

std::shared_ptr<openvdb::GridBase> importRawFiles(const ImportArguments& arguments,
                                                  const Files& files, ProgressBar& bar) {
  if (arguments.series) {
    throw Error(ErrorCode::InvalidArgument, "--series is for a folder of DICOM files");
  }
  RawImport options = arguments.options;
  const auto size = numbersIn<3>("--size", *arguments.size);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (size[axis] != std::floor(size[axis]) || !(std::abs(size[axis]) < 1e9)) {
      throw Error(ErrorCode::InvalidArgument, "--size takes whole numbers of voxels");
    }
    options.size[axis] = static_cast<std::int64_t>(size[axis]);
  }
  options.type = *rawTypeByName(arguments.type);
  if (arguments.spacing) options.spacing = readSpacing(*arguments.spacing);
  if (arguments.origin) {
    const auto origin = numbersIn<3>("--origin", *arguments.origin);
    options.origin = {origin[0], origin[1], origin[2]};
  }
  options.progress = bar.callback();
  return importRaw(files, options);
}

/// A step of another length, in its own direction.
Position scaled(const Position& step, double spacing) {
  const double factor = spacing / std::hypot(step.x, step.y, step.z);
  return {step.x * factor, step.y * factor, step.z * factor};
}

std::shared_ptr<openvdb::GridBase> importImage(const ImportArguments& arguments, ProgressBar& bar) {
  requireImageReader();
  ImageSlices image = openImage(arguments.inputs, arguments.series);
  if (arguments.spacing) {
    const auto spacing = readSpacing(*arguments.spacing);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      image.steps[axis] = scaled(image.steps[axis], spacing[axis]);
    }
  }
  if (arguments.origin) {
    const auto origin = numbersIn<3>("--origin", *arguments.origin);
    image.origin = {origin[0], origin[1], origin[2]};
  }
  SliceOptions options;
  options.threshold = arguments.options.threshold;
  options.labels = arguments.options.labels;
  options.distances = arguments.options.distances;
  options.threads = arguments.options.threads;
  options.progress = bar.callback();
  return importSlices(image, options);
}

/// Throws Error for what images say themselves.
void requireMeaning(const CLI::App& app, const ImportArguments& arguments) {
  if (arguments.size) return;
  for (const char* name : {"--type", "--big-endian", "--header"}) {
    if (app.get_option(name)->count() == 0) continue;
    throw Error(ErrorCode::InvalidArgument,
                std::string(name) + " is for raw values, whose --size must be given");
  }
}

int runImport(const ImportArguments& arguments) {
  keepApart(arguments.output);
  requireVolumeOutput(arguments.output);
  const Files files(arguments.inputs.begin(), arguments.inputs.end());
  for (const std::filesystem::path& file : files) {
    if (isStandard(file.string())) {
      throw Error(ErrorCode::InvalidArgument,
                  "images are read from files, which standard input, -, is not");
    }
    std::error_code error;
    if (!std::filesystem::exists(file, error)) {
      throw Error(ErrorCode::UnreadableFile,
                  "cannot read " + file.string() + ": there is no such file");
    }
  }
  requireDistinct(arguments.output, files);
  std::shared_ptr<openvdb::GridBase> grid;
  const double seconds = timed([&] {
    ProgressBar bar(arguments.quiet);
    grid = arguments.size ? importRawFiles(arguments, files, bar) : importImage(arguments, bar);
  });
  if (grid->empty()) {
    printNote("note: the volume is empty: every value is background" +
              (arguments.options.threshold
                   ? ", as none is " +
                         std::string(arguments.options.distances ? "below" : "above") +
                         " the threshold of " + formatNumber(*arguments.options.threshold)
                   : std::string()));
  }
  WrittenGrid written;
  written.input = arguments.inputs.front();
  written.output = arguments.output;
  written.voxelSize = voxelSizeOf(*grid);
  written.makeSeconds = seconds;
  writeAndTell(grid, std::move(written), {arguments.json, arguments.quiet});
  return kDone;
}

}  // namespace

void addImportCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<ImportArguments>();
  CLI::App* const command = app.add_subcommand("import", "Convert a stack of images to a volume");
  RawImport& options = arguments->options;
  command
      ->add_option("IMAGES", arguments->inputs,
                   imageHelp("a DICOM, NIfTI, NRRD, MetaImage, TIFF or PNG file, the files of the "
                             "slices, or a folder with a DICOM series") +
                       "; with --size files of raw values, x running fastest")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "the .vdb file to write, or - for standard output")
      ->required();
  command->add_option("--size", arguments->size, "X,Y,Z: of raw values, voxels along each axis");
  command->add_option("--type", arguments->type, "of the values")
      ->check(CLI::IsMember({"u8", "u16", "i16", "f32"}))
      ->capture_default_str();
  command->add_flag("--big-endian", options.bigEndian, "the high byte of a value comes first");
  command
      ->add_option("--header", options.headerBytes,
                   "bytes at the beginning of each file to leave out")
      ->check(wholeNumberFrom(0))
      ->capture_default_str();
  command->add_option("--spacing", arguments->spacing,
                      "X,Y,Z: world units between voxels; default: the image's, or 1,1,1");
  command->add_option("--origin", arguments->origin,
                      "X,Y,Z: place of the first voxel; default: the image's, or 0,0,0");
  command->add_option("--series", arguments->series, "UID of the DICOM series in the folder");
  command->add_option("--threshold", options.threshold,
                      "values up to it are background; default: the least value. With --distances: "
                      "values from it on; default: the greatest");
  command->add_flag("--labels", options.labels,
                    "the values name things: keep them as integers, 0 is background");
  command->add_flag("--distances", options.distances,
                    "the values are signed distances in world units, below 0 inside: a level set");
  addThreadsOption(*command, options.threads);
  command->add_flag("--json", arguments->json, "one JSON object on standard output");
  command->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  command->callback([command, arguments, &chosen] {
    chosen = [command, arguments] {
      requireMeaning(*command, *arguments);
      return runImport(*arguments);
    };
  });
}

}  // namespace tufa::tools
