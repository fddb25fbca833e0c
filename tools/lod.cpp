#include <CLI/CLI.hpp>

#include <tufa/check.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/vec3.h"
#include "checker.h"
#include "commands.h"
#include "console.h"
#include "lod_page.h"
#include "paths.h"
#include "progress_bar.h"
#include "report.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct LodArguments {
  std::string input;
  std::string output;
  std::optional<std::string> grid;
  LodOptions lod;
  std::optional<std::string> isovalue;
  std::string tolerance = "0.1";
  std::vector<std::string> tolerances;
  LodWriteOptions writing;
  std::string up = "y";
  std::string scenes = "one";
  bool quantize = false;
  bool compress = false;
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
  LodChain chain;
  bool dropping = false;  ///< components may be left out
  ContourReport contour;
  LodWriteReport written;
  std::vector<double> smallestAngles;  ///< degrees
  std::vector<CheckReport> checks;     ///< empty, or one for each LOD
  double readSeconds = 0;
  double chainSeconds = 0;
  double checkSeconds = 0;
  double writeSeconds = 0;
  Mesh reference;  ///< the uniform mesh, if there is to be a report
};

/// The smallest angle of all triangles, in degrees.
double smallestAngle(const Mesh& mesh) {
  constexpr double kDegrees = 180 / 3.14159265358979323846;
  double smallest = 180;
  for (const Triangle& t : triangulate(mesh)) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto point = [&](std::size_t k) {
        return Vec3(mesh.positions[t.vertices[(i + k) % 3]]);
      };
      const Vec3 a = point(1) - point(0), b = point(2) - point(0);
      smallest = std::min(smallest, kDegrees * std::atan2(a.cross(b).length(), a.dot(b)));
    }
  }
  return smallest;
}

LodOptions chainOptions(const LodArguments& arguments, const openvdb::GridBase& grid,
                        ProgressBar& bar) {
  LodOptions options = arguments.lod;
  options.contour.isovalue = readIsovalue(arguments.isovalue, grid, arguments.input);
  options.contour.tolerance = readTolerance("--tolerance", arguments.tolerance, grid);
  for (const std::string& text : arguments.tolerances) {
    options.tolerances.push_back(readTolerance("--tolerances", text, grid));
  }
  options.contour.progress = bar.callback();
  return options;
}

LodRun runStages(const LodArguments& arguments, ProgressBar& bar) {
  LodRun run;
  std::shared_ptr<openvdb::GridBase> grid;
  run.readSeconds = timed([&] { grid = readVolume(arguments.input, arguments.grid); });
  run.gridName = nameOf(*grid);
  if (!arguments.allowEmpty) requireVoxels(*grid, arguments.input);
  const LodOptions options = chainOptions(arguments, *grid, bar);
  run.dropping = options.allowTopologyChange;
  run.chainSeconds = timed([&] { run.chain = buildLods(*grid, options, &run.contour); });
  if (run.chain.levels.empty() && !run.chain.stopped.empty()) {
    throw Error(ErrorCode::InvalidArgument, run.chain.stopped);
  }
  if (!arguments.quiet) {
    noteIsovalue(arguments.isovalue, *grid, run.contour.isovalue);
    if (!arguments.grid) noteChoice(arguments.input, run.gridName);
  }
  if (!arguments.allowEmpty) {
    requireSurface(run.chain.levels.empty() ? Mesh() : run.chain.levels[0].mesh,
                   run.contour.isovalue, *grid, arguments.input);
  }
  if (arguments.report) {
    ContourOptions uniform = options.contour;
    uniform.uniform = true;
    uniform.progress = bar.callback();
    run.reference = contour(*grid, uniform);
  }
  grid.reset();

  for (const Lod& lod : run.chain.levels) run.smallestAngles.push_back(smallestAngle(lod.mesh));
  if (arguments.check) {
    CheckOptions checkOptions;
    checkOptions.threads = options.contour.threads;
    run.checkSeconds = timed([&] {
      const Progress progress = bar.callback();
      const auto count = static_cast<double>(run.chain.levels.size());
      for (std::size_t level = 0; level < run.chain.levels.size(); ++level) {
        checkOptions.progress = [&](std::string_view stage, double fraction) {
          return progress(stage, (static_cast<double>(level) + fraction) / count);
        };
        run.checks.push_back(check(run.chain.levels[level].mesh, checkOptions));
      }
    });
  }
  LodWriteOptions writing = arguments.writing;
  writing.threads = options.contour.threads;
  writing.progress = bar.callback();
  run.writeSeconds = timed([&] { writeLods(run.chain, arguments.output, writing, &run.written); });
  return run;
}

Json droppedToJson(const Lod& lod) {
  Json json = Json::array();
  for (const DroppedComponent& piece : lod.dropped) {
    json.push_back({{"centre", {piece.centre.x, piece.centre.y, piece.centre.z}},
                    {"size_voxels", piece.sizeVoxels}});
  }
  return json;
}

Json levelToJson(const LodRun& run, std::size_t level) {
  const Lod& lod = run.chain.levels[level];
  Json json;
  json["level"] = level;
  json["tolerance_voxels"] = lod.tolerance;
  json["triangles"] = lod.mesh.triangleCount();
  json["vertices"] = lod.mesh.positions.size();
  json["written_vertices"] = run.written.vertices[level];
  json["max_error_voxels"] = lod.certificate.maxErrorVoxels;
  json["mean_error_voxels"] = lod.certificate.meanErrorVoxels;
  json["max_error_world"] = lod.certificate.maxErrorWorld;
  json["euler_characteristic"] = lod.certificate.eulerCharacteristic;
  json["smallest_angle_degrees"] = run.smallestAngles[level];
  json["screen_coverage"] = lod.screenCoverage;
  json["pairs_left"] = lod.intersectionsLeft;
  if (run.dropping) json["dropped"] = droppedToJson(lod);
  json["seconds"] = lod.seconds;
  if (!run.checks.empty()) json["check"] = toJson(run.checks[level]);
  return json;
}

Json runToJson(const LodRun& run, const LodArguments& arguments) {
  Json json;
  json["file"] = arguments.input;
  json["grid"] = run.gridName;
  json["outputs"] = Json::array();
  for (const auto& file : run.written.files) json["outputs"].push_back(file.string());
  json["isovalue"] = run.contour.isovalue;
  json["inside"] = run.contour.insideIsBelow ? "below" : "above";
  json["active_voxels"] = run.contour.activeVoxels;
  json["non_finite_values"] = run.contour.nonFiniteValues;
  json["open_edges"] = run.contour.openEdges;
  json["voxel_size"] = run.chain.voxelSize;
  json["levels"] = Json::array();
  for (std::size_t level = 0; level < run.chain.levels.size(); ++level) {
    json["levels"].push_back(levelToJson(run, level));
  }
  json["stopped"] = run.chain.stopped;
  json["float_levels"] = run.written.floatLevels;
  json["seconds"] = {{"read", run.readSeconds},
                     {"chain", run.chainSeconds},
                     {"check", run.checkSeconds},
                     {"write", run.writeSeconds},
                     {"shared", run.chain.sharedSeconds}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["threads"] = resolveThreads(arguments.lod.contour.threads);
  return json;
}

/// Columns as wide as their widest cell, each cell to the right.
std::string layOut(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      text += (i > 0 ? "  " : "") + std::string(widths[i] - row[i].size(), ' ') + row[i];
    }
    text += "\n";
  }
  return text;
}

/// Headings and one row for each LOD.
std::vector<std::vector<std::string>> tableOf(const LodRun& run) {
  std::vector<std::vector<std::string>> rows = {{"level", "triangles", "error (voxels)",
                                                 "error (world)", "smallest angle", "coverage",
                                                 "seconds"}};
  if (run.dropping) rows[0].push_back("dropped");
  if (!run.checks.empty()) rows[0].push_back("watertight");
  for (std::size_t level = 0; level < run.chain.levels.size(); ++level) {
    const Lod& lod = run.chain.levels[level];
    rows.push_back({std::to_string(level), formatCount(lod.mesh.triangleCount()),
                    shortNumber(lod.certificate.maxErrorVoxels),
                    shortNumber(lod.certificate.maxErrorWorld),
                    shortNumber(run.smallestAngles[level]), shortNumber(lod.screenCoverage),
                    shortNumber(lod.seconds)});
    if (run.dropping) rows.back().push_back(formatCount(lod.dropped.size()));
    if (!run.checks.empty()) rows.back().push_back(run.checks[level].watertight() ? "yes" : "no");
  }
  return rows;
}

std::string summary(const LodRun& run, const LodArguments& arguments) {
  std::string text = (run.gridName.empty() ? "unnamed grid" : "grid \"" + run.gridName + "\"") +
                     ": " + formatCount(run.contour.activeVoxels) + " active voxels, isovalue " +
                     formatNumber(run.contour.isovalue) + "\n" + layOut(tableOf(run));
  text += "read " + shortNumber(run.readSeconds) + " s, chain " + shortNumber(run.chainSeconds) +
          " s (of which all levels share " + shortNumber(run.chain.sharedSeconds) + " s)";
  if (!run.checks.empty()) text += ", check " + shortNumber(run.checkSeconds) + " s";
  std::vector<std::filesystem::path> files = run.written.files;
  if (arguments.report) files.emplace_back(*arguments.report);
  return text + "\n" + describeWritten(files, run.writeSeconds);
}

/// Prints what the user should know to standard error; returns the exit code.
int judge(const LodRun& run) {
  noteData(run.contour);
  if (!run.chain.stopped.empty()) printNote("note: " + run.chain.stopped);
  for (const std::size_t level : run.written.floatLevels) {
    printNote("note: level " + std::to_string(level) +
              " is stored in floats: 16 bits do not tell all its vertices apart");
  }
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
std::string assetName(const std::filesystem::path& path) {
  std::string name = path.stem().string();
  for (const char* part : {"_LOD{}", "{}"}) {
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
  if (arguments.separate) arguments.output = withBraces(arguments.output).string();
  requireMeshEnding(arguments.output);
  const std::string ending = endingOf(arguments.output);
  if (ending != ".glb") {
    if (ending != ".obj" && command.count("--crease") > 0) {
      throw Error(ErrorCode::InvalidArgument, "--crease is for .glb and .obj only");
    }
    for (const char* option : {"--lod-scenes", "--up", "--scale", "--quantize", "--compress"}) {
      if (command.count(option) == 0) continue;
      throw Error(ErrorCode::InvalidArgument, std::string(option) + " is for .glb only");
    }
    if (lodFile(arguments.output, 0) == arguments.output) {
      throw Error(
          ErrorCode::InvalidArgument,
          arguments.output + ": only .glb holds several levels; --separate makes one file a level");
    }
  }
  if (arguments.check || arguments.report) requireChecker();
  requireDistinctLevels(arguments);
  requireWritable(lodFile(arguments.output, 0));
  if (arguments.report) requireWritable(*arguments.report);
  arguments.writing.name = assetName(arguments.output);
  arguments.writing.allLevelsScene = arguments.scenes == "many";
  arguments.writing.up = arguments.up == "z" ? UpAxis::Z : UpAxis::Y;
  if (arguments.quantize) arguments.writing.compression = LodCompression::Quantized;
  if (arguments.compress) arguments.writing.compression = LodCompression::Meshopt;
}

/// Of the calls that a run makes: how long each is likely to take.
std::vector<double> callShares(const LodArguments& arguments) {
  std::vector<double> shares{kContourShare};
  if (arguments.report) shares.push_back(0.2 * kContourShare);  // the uniform mesh
  if (arguments.check) shares.push_back(kCheckShare);
  shares.push_back(kWriteShare);
  if (arguments.report) shares.push_back(kCheckShare);  // pictures
  return shares;
}

void writeReport(const LodRun& run, const LodArguments& arguments, ProgressBar& bar) {
  LodPage page;
  page.title = arguments.writing.name + ": levels of detail";
  page.summary = arguments.input + (run.gridName.empty() ? "" : ", grid " + run.gridName) + ", " +
                 formatCount(run.contour.activeVoxels) + " active voxels of " +
                 formatNumber(run.chain.voxelSize) +
                 " world units. Errors are distances to the uniform mesh of the grid.";
  if (!run.chain.stopped.empty()) page.summary += " Note: " + run.chain.stopped + ".";
  page.rows = tableOf(run);
  page.headings = page.rows.front();
  page.rows.erase(page.rows.begin());
  page.yUp = arguments.writing.up == UpAxis::Y;
  page.threads = arguments.lod.contour.threads;
  page.progress = bar.callback();
  writeLodPage(run.chain, run.reference, page, *arguments.report);
}

int runLod(const LodArguments& arguments) {
  LodRun run;
  {
    ProgressBar bar(arguments.quiet, callShares(arguments));
    run = runStages(arguments, bar);
    if (arguments.report) writeReport(run, arguments, bar);
  }
  const int exitCode = judge(run);
  if (arguments.json) {
    print(runToJson(run, arguments).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(summary(run, arguments));
  }
  return exitCode;
}

void addChainOptions(CLI::App& app, LodArguments& arguments) {
  app.add_option("--levels", arguments.lod.levels, "most levels")
      ->check(CLI::Range(1, 100))
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
      ->excludes("--levels")
      ->excludes("--tolerance")
      ->excludes("--factor");
  app.add_option("--triangles", arguments.lod.triangles,
                 "most triangles of all levels, falling, with commas between: each level has up to "
                 "5 % fewer")
      ->delimiter(',')
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
                 ".glb and .obj: normals are split where faces differ by more, in degrees")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  app.add_option("--lod-scenes", arguments.scenes,
                 "many: a second scene of all levels, for programs that find them by name")
      ->check(CLI::IsMember({"one", "many"}))
      ->capture_default_str();
  app.add_option("--up", arguments.up, "axis of the volume that points up; glTF's is y")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  app.add_option("--scale", arguments.writing.scale, "metres in a world unit")
      ->check(above0())
      ->capture_default_str();
  app.add_flag("--quantize", arguments.quantize,
               "positions in 16 bits, normals in 8 (KHR_mesh_quantization)");
  app.add_flag("--compress", arguments.compress, "the same and packed (EXT_meshopt_compression)");
  app.add_flag("--separate", arguments.separate, "one file a level: OUT_LOD0, OUT_LOD1, ...");
}

}  // namespace

void addLodCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<LodArguments>();
  CLI::App* const lod = app.add_subcommand("lod", "Make levels of detail of a volume's surface");
  lod->add_option("FILE", arguments->input, "a .vdb file")->required();
  lod->add_option("-o,--output", arguments->output,
                  "a .glb with all levels, or OUT_LOD{}.ply, .obj, .stl, .off or .glb for one "
                  "file a level")
      ->required();
  lod->add_option("--grid", arguments->grid, "name of the grid; default: the first level set");
  addChainOptions(*lod, *arguments);
  addGlbOptions(*lod, *arguments);
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
      settle(*arguments, *lod);
      return runLod(*arguments);
    };
  });
}

}  // namespace tufa::tools
