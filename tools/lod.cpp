#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "attribute_options.h"
#include "checker.h"
#include "commands.h"
#include "console.h"
#include "lod_run.h"
#include "paths.h"
#include "report.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLeastTriangles = 4;  // of a closed surface
constexpr std::array<std::string_view, 2> kFormatsOfLevels = {"glb", "usda"};

/// Prints what the user should know to standard error; returns the exit code.
int judge(const LodRun& run) {
  const bool isFiltered = !run.filters.reports.empty() && !run.chain.levels.empty();
  noteData(run.contour, isFiltered ? &run.chain.levels.front().mesh : nullptr);
  if (!run.chain.stopped.empty()) printNote("note: " + run.chain.stopped);
  for (const std::size_t level : run.written.floatLevels) {
    noteFloats("level " + std::to_string(level));
  }
  noteRounding(run.written.rounding, run.chain.voxelSize);
  int exitCode = kDone;
  for (std::size_t level = 0; level < run.checks.size(); ++level) {
    if (run.checks[level].watertight()) continue;
    noteBroken(run.checks[level], run.contour, "level " + std::to_string(level));
    exitCode = kPromiseBroken;
  }
  return exitCode;
}

/// The output with braces for the LOD's number, if there is to be a file for each.
std::filesystem::path withBraces(const std::filesystem::path& path) {
  if (lodFile(path, 0) != path) return path;
  return path.parent_path() / (path.stem().string() + "_LOD{}" + path.extension().string());
}

/// The name of the asset: that of the file, without the place of the LOD.
std::string assetName(const std::string& output) {
  if (isStandard(output)) return "mesh";
  std::string name = std::filesystem::path(output).stem().string();
  for (const char* part : {"_LOD{}", "_lod{}", "_{}", "-{}", ".{}", "{}"}) {
    const std::size_t at = name.find(part);
    if (at != std::string::npos) name.erase(at, std::string(part).size());
  }
  return name.empty() ? "mesh" : name;
}

/// Throws Error(InvalidArgument) if the file of some LOD, or the page, is the input or another
/// output.
void requireDistinctLevels(const LodArguments& arguments) {
  const LodOptions& lod = arguments.lod;
  const std::size_t most = std::max({static_cast<std::size_t>(std::max(lod.levels, 0)),
                                     arguments.tolerances.size(), lod.triangles.size()});
  std::vector<std::filesystem::path> files;
  for (std::size_t level = 0; level < most; ++level) {
    files.push_back(lodFile(arguments.output, level));
    requireDistinct(files.back(), {arguments.input});
  }
  if (!arguments.report) return;
  files.emplace_back(arguments.input);
  for (const std::filesystem::path& file : files) {
    if (!sameFile(*arguments.report, file)) continue;
    throw Error(ErrorCode::InvalidArgument,
                "--report " + *arguments.report + " would overwrite " + file.string());
  }
  requirePageEnding(*arguments.report);
}

/// Reads options that depend on each other. Throws Error(InvalidArgument).
void settle(LodArguments& arguments, const CLI::App& command) {
  keepApart(arguments.output);
  if (arguments.separate && isStandard(arguments.output)) {
    throw Error(ErrorCode::InvalidArgument, "standard output cannot hold a file for each level");
  }
  if (arguments.separate) arguments.output = withBraces(arguments.output).string();
  const std::string first = lodFile(arguments.output, 0).string();
  requireMeshOutput(first, arguments.format);
  const MeshFormat format = meshFormat(first, arguments.format);
  requireAttributes(arguments.attributes, format);
  const bool glb = format == MeshFormat::Glb, usda = format == MeshFormat::Usda;
  const auto refuse = [&](const char* option, bool known, const char* formats) {
    if (known || command.count(option) == 0) return;
    throw Error(ErrorCode::InvalidArgument, std::string(option) + " is for " + formats + " only");
  };
  refuse("--crease", glb || usda || format == MeshFormat::Obj, ".glb, .obj and .usda");
  for (const char* option : {"--up", "--scale"}) {
    refuse(option, glb || usda || format == MeshFormat::ThreeMf, ".glb, .usda and .3mf");
  }
  for (const char* option : {"--lod-scenes", "--quantize", "--compress"}) {
    refuse(option, glb, ".glb");
  }
  if (!glb && !usda && lodFile(arguments.output, 0) == arguments.output) {
    throw Error(ErrorCode::InvalidArgument,
                arguments.output +
                    ": only .glb and .usda hold several levels; --separate makes one file a level");
  }
  if (arguments.check || arguments.report) requireChecker();
  requireDistinctLevels(arguments);
  if (arguments.report) requireWritable(*arguments.report);
  arguments.writing.name = assetName(arguments.output);
  arguments.writing.allLevelsScene = arguments.scenes == "many";
}

int runLod(const LodArguments& arguments) {
  const LodRun run = makeLods(arguments);
  const int exitCode = judge(run);
  if (arguments.json) {
    print(toJson(run, arguments).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(describe(run, arguments));
  }
  return exitCode;
}

void addChainOptions(CLI::App& app, LodArguments& arguments) {
  app.add_option("--levels", arguments.lod.levels, "most levels")
      ->check(wholeNumberIn(1, 100))
      ->capture_default_str();
  app.add_option("--tolerance", arguments.tolerance,
                 "largest distance of level 0 to the uniform mesh, in voxels, or with the suffix w "
                 "in world units")
      ->capture_default_str();
  app.add_option("--factor", arguments.lod.factor,
                 "each level's tolerance over that of the level before")
      ->capture_default_str();
  app.add_option("--tolerances", arguments.tolerances,
                 "tolerances of all levels, rising, with commas between")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->excludes("--levels")
      ->excludes("--tolerance")
      ->excludes("--factor");
  app.add_option("--tolerance-grid", arguments.toleranceGrid,
                 "float grid of the file that multiplies the tolerances in space");
  app.add_option("--triangles", arguments.lod.triangles,
                 "most triangles of all levels, falling, with commas between: each level has up to "
                 "5 % fewer")
      ->check(wholeNumberFrom(kLeastTriangles))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->excludes("--levels")
      ->excludes("--tolerance")
      ->excludes("--factor")
      ->excludes("--tolerances");
  app.add_flag("--allow-topology-change", arguments.lod.allowTopologyChange,
               "leave out components and closed cavities smaller than a level's tolerance; tunnels "
               "and handles stay");
}

void addGlbOptions(CLI::App& app, LodArguments& arguments) {
  app.add_option("--crease", arguments.writing.creaseAngle,
                 ".glb, .obj and .usda: normals are split where faces differ by more, in degrees")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  app.add_option("--lod-scenes", arguments.scenes,
                 "many: a second scene of all levels, for programs that find them by name")
      ->check(CLI::IsMember({"one", "many"}))
      ->capture_default_str();
  addFrameOptions(app, arguments.writing.up, arguments.writing.scale);
  addCompressionOptions(app, arguments.writing.compression);
  app.add_flag("--separate", arguments.separate, "one file a level: OUT_LOD0, OUT_LOD1, ...");
}

}  // namespace

void addLodCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<LodArguments>();
  CLI::App* const lod = app.add_subcommand("lod", "Make levels of detail of a volume's surface");
  lod->add_option("FILE", arguments->input, "a .vdb file, or - for standard input")->required();
  lod->add_option("-o,--output", arguments->output,
                  "a .glb or .usda with all levels, or OUT_LOD{} with any ending of tufa mesh for "
                  "one file a level, or - for standard output")
      ->required();
  addFormatOption(*lod, arguments->format, "of standard output, a pipe or a device",
                  kFormatsOfLevels);
  lod->add_option("--grid", arguments->grid, "name of the grid; default: the first level set");
  addChainOptions(*lod, *arguments);
  addGlbOptions(*lod, *arguments);
  addFilterOptions(*lod, arguments->filters);
  addAttributeOptions(*lod, arguments->attributes);
  addContourOptions(*lod, arguments->lod.contour, arguments->isovalue);
  lod->add_flag("--allow-empty", arguments->allowEmpty,
                "write an empty file where the grid has no surface");
  lod->add_option("--report", arguments->report,
                  checkerHelp("a page of HTML with pictures of all levels"));
  lod->add_flag("--check", arguments->check,
                checkerHelp("check every level; exit 1 if one is not watertight"));
  lod->add_flag("--json", arguments->json, "one JSON object on standard output");
  lod->add_flag("--quiet", arguments->quiet, "no table and no progress bar");
  lod->callback([arguments, lod, &chosen] {
    chosen = [arguments, lod] {
      orderFilters(*lod, arguments->filters);
      settle(*arguments, *lod);
      return runLod(*arguments);
    };
  });
}

}  // namespace tufa::tools
