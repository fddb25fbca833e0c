#include <tufa/fit.h>

#include <CLI/CLI.hpp>

#include <tufa/io.h>
#include <tufa/memory.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "commands.h"
#include "console.h"
#include "number_list.h"
#include "open_edges.h"
#include "paths.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

struct FitArguments {
  std::string input;
  std::string output;
  std::optional<std::string> format;
  std::optional<std::string> weights;
  FitOptions options;
  bool json = false;
  bool quiet = false;
};

std::string describeFit(const BlobFit& fit) {
  const auto share = [&](double distance) {
    return formatNumber(distance) + " (" + formatNumber(100 * distance / fit.diagonal) +
           "% of the diagonal)";
  };
  return formatCount(fit.blobs.size()) + " blobs, rms distance " + share(fit.rmsDistance) +
         ", largest " + share(fit.largestDistance) + "\n";
}

nlohmann::ordered_json fitJson(const BlobFit& fit) {
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  for (const FitStep& step : fit.steps) {
    steps.push_back(
        {{"blobs", step.blobs}, {"energy", step.energy}, {"rms_distance", step.rmsDistance}});
  }
  return {{"blobs", fit.blobs.size()},
          {"diagonal", fit.diagonal},
          {"rms_distance", fit.rmsDistance},
          {"largest_distance", fit.largestDistance},
          {"steps", std::move(steps)}};
}

int runFit(const FitArguments& arguments) {
  requireFile(arguments.output, "a scene");
  if (!arguments.output.ends_with(".json")) {
    throw Error(ErrorCode::InvalidArgument,
                "cannot write " + arguments.output + ": a scene is a .json file");
  }
  requireDistinct(arguments.output, {arguments.input});
  requireWritable(arguments.output);
  FitOptions options = arguments.options;
  if (arguments.weights) {
    const auto weights = numbersIn<3>("--weights", *arguments.weights);
    options.valueWeight = weights[0];
    options.normalWeight = weights[1];
    options.shrinkWeight = weights[2];
  }
  const Mesh mesh = readMeshInput(arguments.input, arguments.format);
  if (!arguments.quiet) noteOpenMesh(mesh, "the inside");
  BlobFit fit;
  const double seconds = timed([&] {
    ProgressBar bar(arguments.quiet);
    options.progress = bar.callback();
    fit = fitBlobs(mesh, options);
  });
  const double writeSeconds = timed([&] { writeFile(sceneOf(fit), arguments.output); });
  if (arguments.json) {
    nlohmann::ordered_json json = {{"file", arguments.input}, {"output", arguments.output}};
    json.update(fitJson(fit));
    json["seconds"] = seconds;
    print(json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(describeFit(fit) + describeWritten({arguments.output}, writeSeconds));
  }
  return kDone;
}

}  // namespace

void addFitCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<FitArguments>();
  CLI::App* const fit = app.add_subcommand(
      "fit", std::string("Describe a mesh by blobs, as a scene of metaballs") +
                 (canFitBlobs() ? "" : " (this tufa was built without Ceres Solver)"));
  FitOptions& options = arguments->options;
  fit->add_option("MESH", arguments->input,
                  "a .ply, .obj, .stl, .off or .glb file, or - for standard input: closed, facing "
                  "outward")
      ->required();
  addInputFormatOption(*fit, arguments->format);
  fit->add_option("-o,--output", arguments->output, "the .json scene to write")->required();
  fit->add_option("--blobs", options.blobs, "most blobs")->capture_default_str();
  fit->add_option("--error", options.error,
                  "stop once the rms distance is at most this share of the mesh's diagonal; 0: go "
                  "on to the number of blobs")
      ->capture_default_str();
  fit->add_option("--samples", options.samples,
                  "points taken on the mesh; 0: 2000, and 20 for each blob")
      ->capture_default_str();
  fit->add_option("--weights", arguments->weights,
                  "VALUE,NORMAL,SHRINK: of the energy's terms; default: 1,0.01,0.0001");
  addThreadsOption(*fit, options.threads);
  fit->add_flag("--json", arguments->json, "one JSON object on standard output");
  fit->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  fit->callback([arguments, &chosen] { chosen = [arguments] { return runFit(*arguments); }; });
}

}  // namespace tufa::tools
