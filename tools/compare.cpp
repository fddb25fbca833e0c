#include <CLI/CLI.hpp>

#include <tufa/compare.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "checker.h"
#include "commands.h"
#include "compare_run.h"
#include "console.h"
#include "paths.h"
#include "progress_bar.h"
#include "truth.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

enum class ReportKind { Page, Object, Table };

/// Throws Error(InvalidArgument) for another ending.
ReportKind kindOf(const std::string& output) {
  const std::string ending = endingOf(output);
  if (ending == ".html" || ending == ".htm") return ReportKind::Page;
  if (ending == ".json") return ReportKind::Object;
  if (ending == ".md") return ReportKind::Table;
  throw Error(ErrorCode::InvalidArgument,
              "a comparison is written as .html, .json or .md, and " + output + " ends in none");
}

bool wantsPage(const CompareArguments& arguments) {
  return std::any_of(arguments.outputs.begin(), arguments.outputs.end(),
                     [](const std::string& output) { return kindOf(output) == ReportKind::Page; });
}

void requireFeasible(const CompareArguments& arguments) {
  requireChecker();
  for (std::size_t i = 0; i < arguments.outputs.size(); ++i) {
    const std::string& output = arguments.outputs[i];
    static_cast<void>(kindOf(output));
    requireDistinct(output, {arguments.input});
    for (std::size_t k = 0; k < i; ++k) {
      if (!sameFile(output, arguments.outputs[k])) continue;
      throw Error(ErrorCode::InvalidArgument, "two outputs are the same file: " + output);
    }
    requireWritable(output);
  }
}

CompareRun compareFile(const CompareArguments& arguments, ProgressBar& bar) {
  CompareRun run;
  const auto grid = readVolume(arguments.input, arguments.grid);
  run.gridName = nameOf(*grid);
  requireVoxels(*grid, arguments.input);
  CompareOptions options = arguments.options;
  ContourOptions& contour = options.extract.contour;
  contour.isovalue = readIsovalue(arguments.isovalue, *grid, arguments.input);
  contour.tolerance = readTolerance("--tolerance", arguments.tolerance, *grid);
  contour.progress = bar.callback();
  options.memory = true;
  options.keepMeshes = wantsPage(arguments);
  if (arguments.truth) setTruth(*arguments.truth, voxelSizeOf(*grid), options);
  run.seconds = timed([&] { run.comparison = compareMethods(*grid, options); });
  if (!run.comparison.differsAt) {
    requireSurface(Mesh(), run.comparison.isovalue, *grid, arguments.input);
  }
  if (arguments.quiet) return run;
  noteIsovalue(arguments.isovalue, *grid, run.comparison.isovalue);
  if (!arguments.grid) noteChoice(arguments.input, run.gridName);
  return run;
}

std::string jsonText(const CompareRun& run, const CompareArguments& arguments) {
  return toJson(run, arguments).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writeReport(const CompareRun& run, const CompareArguments& arguments,
                 const std::string& output, ProgressBar& bar) {
  switch (kindOf(output)) {
    case ReportKind::Page:
      return writeFile(pageOf(run, arguments, bar.callback()), output);
    case ReportKind::Object:
      return writeFile(jsonText(run, arguments), output);
    case ReportKind::Table:
      return writeFile(summaryOf(run, arguments) + "\n\n" + markdownOf(tableOf(run.comparison)),
                       output);
  }
}

int runCompare(const CompareArguments& arguments) {
  requireFeasible(arguments);
  CompareRun run;
  double writeSeconds = 0;
  {
    constexpr double kPicturesShare = 0.1;
    ProgressBar bar(arguments.quiet, {1, kPicturesShare});
    run = compareFile(arguments, bar);
    writeSeconds = timed([&] {
      for (const std::string& output : arguments.outputs) {
        writeReport(run, arguments, output, bar);
      }
    });
  }
  if (arguments.json) {
    print(jsonText(run, arguments));
  } else if (!arguments.quiet) {
    print(summaryOf(run, arguments) + "\n" + layOut(tableOf(run.comparison)));
    const std::vector<std::filesystem::path> files(arguments.outputs.begin(),
                                                   arguments.outputs.end());
    if (!files.empty()) print(describeWritten(files, writeSeconds));
  }
  return kDone;
}

}  // namespace

void addCompareCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* const compare = app.add_subcommand(
      "compare", checkerHelp("Mesh a volume in several ways and measure what each costs and "
                             "breaks"));
  compare->add_option("FILE", arguments->input, "a .vdb file, or - for standard input")->required();
  compare
      ->add_option("-o,--output", arguments->outputs,
                   "a report: .html with pictures, .json or .md; may be given several times")
      ->allow_extra_args(false);
  compare->add_option("--grid", arguments->grid, "name of the grid; default: the first level set");
  compare
      ->add_option("--methods", arguments->options.methods,
                   "which ones, with commas between; default: all")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(
          CLI::IsMember(std::vector<std::string>(comparedNames().begin(), comparedNames().end())));
  compare
      ->add_option("--truth", arguments->truth,
                   "the shape of tufa make that the volume is of: distances to it are measured too")
      ->check(CLI::IsMember(namesOfTruths()));
  compare
      ->add_option("--repeats", arguments->options.repeats,
                   "runs of each method, of which the quickest counts")
      ->check(wholeNumberIn(1, 1000))
      ->capture_default_str();
  compare
      ->add_option(
          "--tolerance", arguments->tolerance,
          "of dual, octree-mc and cms-adaptive, in voxels, or with the suffix w in world units")
      ->capture_default_str();
  compare
      ->add_option(
          "--sharp-angle", arguments->options.extract.sharpAngle,
          "of emc and cms: normals in a cell that differ by more, in degrees, mean a crease")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  addContourOptions(*compare, arguments->options.extract.contour, arguments->isovalue);
  compare->add_flag("--json", arguments->json, "one JSON object on standard output");
  compare->add_flag("--quiet", arguments->quiet, "no table and no progress bar");
  compare->callback(
      [arguments, &chosen] { chosen = [arguments] { return runCompare(*arguments); }; });
}

}  // namespace tufa::tools
