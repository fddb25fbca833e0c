#include <CLI/CLI.hpp>

#include <tufa/check.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "checker.h"
#include "commands.h"
#include "console.h"
#include "file_list.h"
#include "progress_bar.h"
#include "report.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  std::vector<std::string> inputs;
  std::optional<std::string> format;  ///< of standard input
  std::optional<std::string> against;
  std::optional<std::string> grid;
  std::optional<std::string> isovalue;
  int threads = 0;
  bool json = false;
  bool quiet = false;
};

CheckReport checkMesh(const Mesh& mesh, const CheckArguments& arguments, ProgressBar& bar) {
  CheckOptions options;
  options.threads = arguments.threads;
  options.progress = bar.callback();
  return check(mesh, options);
}

DistanceReport measureDistance(const Mesh& mesh, const openvdb::GridBase& grid,
                               const std::optional<double>& isovalue,
                               const CheckArguments& arguments, ProgressBar& bar) {
  DistanceOptions options;
  options.isovalue = isovalue;
  options.threads = arguments.threads;
  options.progress = bar.callback();
  return checkAgainst(mesh, grid, options);
}

/// What meshes are measured against.
struct Truth {
  std::shared_ptr<openvdb::GridBase> grid;
  std::optional<double> isovalue;
};

/// Throws Error(InvalidArgument) for a folder of chunks, whose files each hold a part of a surface.
void requireMesh(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(std::filesystem::path(file) / "chunks.json", error)) return;
  throw Error(ErrorCode::InvalidArgument, file + " is a folder of chunks: tufa chunks --assemble " +
                                              file + " --lods all:0 -o MESH --check checks them");
}

/// Says of a file of a chunk that it is no mesh by itself.
void noteChunk(const std::filesystem::path& file) {
  std::error_code error;
  if (!file.filename().string().starts_with("chunk_") ||
      !std::filesystem::exists(file.parent_path() / "chunks.json", error)) {
    return;
  }
  printNote(
      "note: " + file.string() +
      " is one chunk, both strips at each face in it; tufa chunks --assemble makes one mesh of "
      "its folder");
}

int checkFile(const std::string& file, const Truth& truth, const CheckArguments& arguments,
              FileList& files) {
  requireMesh(file);
  const Mesh mesh = readMeshInput(file, isStandard(file) ? arguments.format : std::nullopt);
  // Distances are measured at many places of both surfaces, about as long as all else takes.
  ProgressBar bar(arguments.quiet, truth.grid ? std::vector{1.0, 1.0} : std::vector{1.0});
  const CheckReport report = checkMesh(mesh, arguments, bar);
  std::optional<DistanceReport> distance;
  if (truth.grid) {
    distance = measureDistance(mesh, *truth.grid, truth.isovalue, arguments, bar);
    if (distance->surfaceToMesh.samples == 0) {
      requireSurface({}, distance->isovalue, *truth.grid, *arguments.against);
    }
  }

  if (distance && !arguments.quiet) {
    noteIsovalue(arguments.isovalue, *truth.grid, distance->isovalue);
  }
  if (arguments.json) {
    Json json;
    json["file"] = file;
    json.update(toJson(report));
    if (distance) {
      json["distance"] = {{"file", *arguments.against}, {"grid", nameOf(*truth.grid)}};
      json["distance"].update(toJson(*distance));
    }
    files.add(std::move(json));
  } else if (!arguments.quiet) {
    print(shownInput(file) + "\n" + (distance ? describe(*distance) : "") + describe(report));
  }
  if (!report.watertight() && !arguments.quiet) noteChunk(file);
  return report.watertight() ? kDone : kPromiseBroken;
}

void requireFeasible(const CheckArguments& arguments) {
  requireChecker();
  const auto standard =
      std::count(arguments.inputs.begin(), arguments.inputs.end(), std::string("-"));
  if (standard + (arguments.against == "-" ? 1 : 0) > 1) {
    throw Error(ErrorCode::InvalidArgument, "standard input, -, can be read once only");
  }
  if (standard == 1) static_cast<void>(meshFormat("-", arguments.format));
  if (standard == 0 && arguments.format) {
    throw Error(ErrorCode::InvalidArgument, "--format is for standard input, -");
  }
}

int runCheck(const CheckArguments& arguments) {
  requireFeasible(arguments);
  Truth truth;
  if (arguments.against) {
    truth.grid = readVolume(*arguments.against, arguments.grid);
    if (!arguments.grid && !arguments.quiet) noteChoice(*arguments.against, nameOf(*truth.grid));
    truth.isovalue = readIsovalue(arguments.isovalue, *truth.grid, *arguments.against);
  }
  FileList files(arguments.inputs, arguments.json);
  files.forEach([&](const std::string& file) { return checkFile(file, truth, arguments, files); });
  return files.finish();
}

}  // namespace

void addCheckCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* const check = app.add_subcommand(
      "check", checkerHelp("Say whether a mesh is watertight; exit code 1 if it is not"));
  check
      ->add_option("MESH", arguments->inputs,
                   "a .ply, .obj, .stl, .off or .glb file, or several; - for standard input")
      ->required();
  addInputFormatOption(*check, arguments->format);
  CLI::Option* const against =
      check->add_option("--against", arguments->against,
                        "measure the distance to the isosurface of a grid of this .vdb file");
  check->add_option("--grid", arguments->grid, "the grid's name")->needs(against);
  addIsovalueOption(*check, arguments->isovalue)->needs(against);
  addThreadsOption(*check, arguments->threads);
  check->add_flag("--json", arguments->json, "one JSON object on standard output");
  check->add_flag("--quiet", arguments->quiet, "no text, only the exit code");
  check->callback([arguments, &chosen] { chosen = [arguments] { return runCheck(*arguments); }; });
}

}  // namespace tufa::tools
