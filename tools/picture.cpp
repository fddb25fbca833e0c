#include <tufa/picture.h>

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/io.h>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "commands.h"
#include "console.h"
#include "number.h"
#include "paths.h"
#include "progress_bar.h"
#include "render/image.h"
#include "scene_input.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct PictureArguments {
  std::string input;
  std::string output;
  std::string size = "900x700";
  std::string camera;
  std::optional<std::string> grid;
  std::optional<std::string> isovalue;
  std::optional<std::string> bounds;
  std::optional<std::string> compare;
  std::optional<std::string> format;
  std::optional<double> voxelSize;
  PictureOptions options;
  bool json = false;
  bool quiet = false;
};

/// What is looked at.
struct Subject {
  std::shared_ptr<const RaySurface> surface;
  double voxelSize = 0;
};

struct PictureRun {
  std::optional<Picture> picture;
  std::optional<SurfaceComparison> comparison;
  double tolerance = 0;
  double readSeconds = 0;
  double pictureSeconds = 0;
  double compareSeconds = 0;
  double writeSeconds = 0;
};

void readSize(const std::string& text, PictureOptions& options) {
  const std::size_t times = text.find('x');
  const auto width = numberIn<int>(text.substr(0, times));
  const auto height =
      times == std::string::npos ? std::nullopt : numberIn<int>(text.substr(times + 1));
  if (!width || !height) {
    throw Error(ErrorCode::InvalidArgument, "--size takes WIDTHxHEIGHT, not \"" + text + "\"");
  }
  options.width = *width;
  options.height = *height;
}

/// "azimuth=35,elevation=25,...".
void readCamera(const std::string& text, PictureView& view) {
  Position centre(0, 0, 0);
  int placed = 0;
  std::set<std::string> given;
  const std::map<std::string, double*> numbers = {{"azimuth", &view.azimuth},
                                                  {"elevation", &view.elevation},
                                                  {"fov", &view.fieldOfView},
                                                  {"width", &view.width},
                                                  {"x", &centre.x},
                                                  {"y", &centre.y},
                                                  {"z", &centre.z}};
  if (text.empty()) return;
  for (const std::string& item : CLI::detail::split(text, ',')) {
    const std::size_t equals = item.find('=');
    const std::string key = item.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : item.substr(equals + 1);
    if (!given.insert(key).second) {
      throw Error(ErrorCode::InvalidArgument,
                  "--camera takes " + key + "= once, not \"" + text + "\"");
    }
    if (key == "up" && (value == "y" || value == "z")) {
      view.yUp = value == "y";
      continue;
    }
    const auto place = numbers.find(key);
    const auto number = numberIn<double>(value);
    if (place == numbers.end() || !number) {
      throw Error(ErrorCode::InvalidArgument,
                  "--camera takes azimuth=, elevation=, fov=, width=, x=, y=, z= with numbers and "
                  "up=y or up=z, with commas between them, not \"" +
                      item + "\"");
    }
    *place->second = *number;
    if (key.size() == 1) ++placed;
  }
  if (placed > 0 && placed < 3) {
    throw Error(ErrorCode::InvalidArgument, "--camera takes x, y and z together");
  }
  if (placed > 0) view.centre = centre;
}

/// Throws Error(UnsupportedGrid) if a volume has no surface, as tufa mesh does.
void requireSomething(const RaySurface& surface, const openvdb::GridBase& grid,
                      const std::optional<double>& isovalue, const std::string& file) {
  const implicit::Box box = boundsOf(surface);
  const bool isEmpty = box.least.x == box.greatest.x && box.least.y == box.greatest.y &&
                       box.least.z == box.greatest.z;
  if (isEmpty && (isovalue || isLevelSet(grid))) {
    requireSurface({}, isovalue.value_or(0), grid, file);
  }
}

/// What is on standard input its first character tells: JSON begins with a brace.
bool isScene(const std::string& name) {
  if (!isStandard(name)) return endingOf(name) == ".json";
  const std::string_view bytes = standardInput().bytes;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && bytes[first] == '{';
}

/// Throws Error(InvalidArgument) for options that the other kind of input takes.
void requireSense(const PictureArguments& arguments) {
  if (arguments.voxelSize && !arguments.compare) {
    throw Error(ErrorCode::InvalidArgument, "--voxel is for --compare, which is not there");
  }
  if (arguments.output.empty() && !arguments.compare) {
    throw Error(ErrorCode::InvalidArgument, "--output is required, or --compare to look at a mesh");
  }
  if (isStandard(arguments.input) && isStandard(arguments.compare.value_or(""))) {
    throw Error(ErrorCode::InvalidArgument,
                "standard input holds one file: --compare needs a name");
  }
  if (arguments.format && !arguments.compare) {
    throw Error(ErrorCode::InvalidArgument, "--format is for --compare, which is not there");
  }
  const bool scene = isScene(arguments.input);
  const auto refuse = [&](bool given, const std::string& option, const std::string& kind) {
    if (!given) return;
    throw Error(ErrorCode::InvalidArgument,
                option + " is for " + kind + ", which " + shownInput(arguments.input) + " is not");
  };
  refuse(scene && arguments.grid, "--grid", "a volume");
  refuse(scene && arguments.isovalue, "--iso", "a volume");
  refuse(!scene && arguments.bounds, "--bounds", "a scene");
  refuse(!scene && arguments.voxelSize, "--voxel", "a scene");
}

Subject readSubject(const PictureArguments& arguments, const RaySurfaceOptions& common) {
  Subject subject;
  RaySurfaceOptions options = common;
  if (isScene(arguments.input)) {
    const implicit::Scene scene = readSceneInput(arguments.input, arguments.bounds);
    subject.voxelSize =
        arguments.voxelSize.value_or(scene.voxelSize.value_or(voxelSizeFor(*scene.field)));
    subject.surface = makeRaySurface(scene.field, options);
    return subject;
  }
  const std::shared_ptr<const openvdb::GridBase> grid = readVolume(arguments.input, arguments.grid);
  if (!arguments.grid && !arguments.quiet) noteChoice(arguments.input, nameOf(*grid));
  requireVoxels(*grid, arguments.input);
  options.isovalue = readIsovalue(arguments.isovalue, *grid, arguments.input);
  subject.surface = makeRaySurface(grid, options);
  requireSomething(*subject.surface, *grid, options.isovalue, arguments.input);
  subject.voxelSize = voxelSizeOf(*grid);
  return subject;
}

void write(const Picture& picture, const std::string& output) {
  render::Image image;
  image.width = picture.width;
  image.height = picture.height;
  image.pixels = picture.pixels;
  const std::string bytes = render::pngOf(image);
  if (isDirect(output)) {
    writeDirect(output, [&](std::ostream& stream) { stream << bytes << std::flush; });
  } else {
    writeFile(bytes, output);
  }
}

Json pictureJson(const PictureArguments& arguments, const PictureRun& run) {
  Json json;
  json["file"] = arguments.input;
  if (run.picture) {
    json["output"] = arguments.output;
    json["size"] = {run.picture->width, run.picture->height};
    json["samples"] = arguments.options.samples;
    json["covered"] = run.picture->covered;
  }
  if (run.comparison) {
    json["compare"] = {
        {"mesh", *arguments.compare},       {"tolerance", run.tolerance},
        {"pixels", run.comparison->pixels}, {"silhouette", run.comparison->silhouette},
        {"depth", run.comparison->depth},   {"share", run.comparison->share()}};
  }
  json["seconds"] = {{"read", run.readSeconds},
                     {"picture", run.pictureSeconds},
                     {"compare", run.compareSeconds},
                     {"write", run.writeSeconds}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  return json;
}

std::string describePicture(const PictureArguments& arguments, const PictureRun& run) {
  std::string text;
  if (run.comparison) {
    const SurfaceComparison& found = *run.comparison;
    text += shortNumber(100 * found.share()) + "% of " + formatCount(found.pixels) +
            " pixels differ by more than " + shortNumber(run.tolerance) +
            " (half a voxel): " + formatCount(found.silhouette) + " in the silhouette, " +
            formatCount(found.depth) + " in depth, in " + shortNumber(run.compareSeconds) + " s\n";
  }
  if (run.picture) {
    text += std::to_string(run.picture->width) + " x " + std::to_string(run.picture->height) +
            " pixels, " + std::to_string(arguments.options.samples) +
            (arguments.options.samples == 1 ? " sample each, " : " samples each, ") +
            shortNumber(100 * run.picture->covered) + "% covered, in " +
            shortNumber(run.pictureSeconds) + " s\n";
    text += describeWritten({arguments.output}, run.writeSeconds);
  }
  return text;
}

SurfaceComparison compareWith(const PictureArguments& arguments, const Subject& subject,
                              const RaySurfaceOptions& common, ProgressBar& bar) {
  const Mesh mesh = readMeshInput(*arguments.compare, arguments.format);
  RaySurfaceOptions options = common;
  options.progress = bar.callback();
  const auto surface = makeRaySurface(mesh, options);
  PictureOptions view = arguments.options;
  view.progress = bar.callback();
  return compareSurfaces(*subject.surface, *surface, subject.voxelSize / 2, view);
}

int runPicture(PictureArguments& arguments) {
  requireSense(arguments);
  if (!arguments.output.empty()) {
    keepApart(arguments.output);
    requirePictureOutput(arguments.output);
    std::vector<std::filesystem::path> inputs = {arguments.input};
    if (arguments.compare) inputs.emplace_back(*arguments.compare);
    requireDistinct(arguments.output, inputs);
  }
  readSize(arguments.size, arguments.options);
  readCamera(arguments.camera, arguments.options.view);
  if (arguments.voxelSize) requireVoxelSize("--voxel", *arguments.voxelSize);

  PictureRun run;
  constexpr double kPrepareShare = 1, kMeshShare = 0.2, kCompareShare = 2, kPictureShare = 20;
  std::vector<double> shares = {kPrepareShare};
  if (arguments.compare) shares.insert(shares.end(), {kMeshShare, kCompareShare});
  if (!arguments.output.empty()) shares.push_back(kPictureShare);
  ProgressBar bar(arguments.quiet, shares);
  RaySurfaceOptions common;
  common.threads = arguments.options.threads;
  Subject subject;
  run.readSeconds = timed([&] {
    RaySurfaceOptions options = common;
    options.progress = bar.callback();
    subject = readSubject(arguments, options);
  });
  run.tolerance = subject.voxelSize / 2;
  if (arguments.compare) {
    run.compareSeconds =
        timed([&] { run.comparison = compareWith(arguments, subject, common, bar); });
  }
  if (!arguments.output.empty()) {
    PictureOptions options = arguments.options;
    options.progress = bar.callback();
    run.pictureSeconds = timed([&] { run.picture = takePicture(*subject.surface, options); });
    run.writeSeconds = timed([&] { write(*run.picture, arguments.output); });
    if (run.picture->covered == 0) {
      printNote("note: the picture is empty: no ray met a surface of " +
                shownInput(arguments.input));
    }
  }
  if (arguments.json) {
    print(pictureJson(arguments, run).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(describePicture(arguments, run));
  }
  return kDone;
}

}  // namespace

void addPictureCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<PictureArguments>();
  CLI::App* const picture =
      app.add_subcommand("picture", "Take a picture of a volume or a scene by ray casting");
  PictureOptions& options = arguments->options;
  picture
      ->add_option("FILE", arguments->input,
                   "a .vdb file, a scene in .json, or - for either on standard input")
      ->required();
  picture->add_option("-o,--output", arguments->output,
                      "the .png file to write, or - for standard output");
  picture->add_option("--size", arguments->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  picture->add_option("--samples", options.samples, "rays for each pixel; more of them, less noise")
      ->capture_default_str();
  picture->add_option("--camera", arguments->camera,
                      "azimuth=35,elevation=25,fov=0,width=0,x=,y=,z=,up=z: degrees, the angle of "
                      "view (0: parallel rays), world units from left to right (0: all), the "
                      "centre, and the axis that points up");
  addIsovalueOption(*picture, arguments->isovalue);
  picture->add_option("--grid", arguments->grid, "name of the grid");
  picture->add_option("--bounds", arguments->bounds,
                      "X0,Y0,Z0,X1,Y1,Z1: of a scene, the box that it is cut by");
  picture->add_option("--compare", arguments->compare,
                      "a mesh, or - for standard input: print the share of pixels where its "
                      "silhouette or depth differs by more than half a voxel");
  addInputFormatOption(*picture, arguments->format);
  picture->add_option("--voxel", arguments->voxelSize,
                      "of a scene, with --compare: what a voxel is; default: the scene's, or a "
                      "hundredth of its longest side");
  picture->add_flag("!--no-shadows", options.shadows, "no shadows of the lamp");
  picture->add_flag("!--no-occlusion", options.occlusion, "no ambient occlusion");
  addThreadsOption(*picture, options.threads);
  picture->add_flag("--json", arguments->json, "one JSON object on standard output");
  picture->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  picture->callback(
      [arguments, &chosen] { chosen = [arguments] { return runPicture(*arguments); }; });
}

}  // namespace tufa::tools
