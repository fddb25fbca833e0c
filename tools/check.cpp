#include <CLI/CLI.hpp>

#include <tufa/check.h>
#include <tufa/io.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "checker.h"
#include "commands.h"
#include "console.h"
#include "progress_bar.h"
#include "report.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  std::string input;
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

int runCheck(const CheckArguments& arguments) {
  requireChecker();
  // Both files are read before the work begins: a wrong name should not show minutes later.
  const Mesh mesh = readMesh(arguments.input);
  std::shared_ptr<openvdb::GridBase> grid;
  std::optional<double> isovalue;
  if (arguments.against) {
    grid = readVolume(*arguments.against, arguments.grid);
    isovalue = readIsovalue(arguments.isovalue, *grid, *arguments.against);
  }

  // Distances are measured at many places of both surfaces, about as long as all else takes.
  ProgressBar bar(arguments.quiet, grid ? std::vector{1.0, 1.0} : std::vector{1.0});
  const CheckReport report = checkMesh(mesh, arguments, bar);
  std::optional<DistanceReport> distance;
  if (grid) distance = measureDistance(mesh, *grid, isovalue, arguments, bar);

  if (arguments.json) {
    Json json;
    json["file"] = arguments.input;
    json.update(toJson(report));
    if (distance) json["distance"] = toJson(*distance);
    print(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(arguments.input + "\n" + (distance ? describe(*distance) : "") + describe(report));
  }
  return report.watertight() ? kDone : kPromiseBroken;
}

}  // namespace

void addCheckCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* const check = app.add_subcommand(
      "check", checkerHelp("Say whether a mesh is watertight; exit code 1 if it is not"));
  check->add_option("MESH", arguments->input, "a .ply, .obj, .stl, .off or .glb file")->required();
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
