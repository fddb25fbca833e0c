#include <CLI/CLI.hpp>

#include <tufa/check.h>
#include <tufa/io.h>
#include <tufa/repair.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "checker.h"
#include "commands.h"
#include "console.h"
#include "paths.h"
#include "progress_bar.h"
#include "report.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct RepairArguments {
  std::string input;
  std::string output;
  std::optional<std::string> format;
  RepairOptions options;
  bool json = false;
  bool quiet = false;
};

Json repairJson(const RepairReport& report) {
  return {{"merged_vertices", report.mergedVertices},
          {"unused_vertices", report.unusedVertices},
          {"degenerate_faces", report.degenerateFaces},
          {"duplicate_faces", report.duplicateFaces},
          {"split_vertices", report.splitVertices},
          {"filled_holes", report.filledHoles},
          {"dropped_parts", report.droppedParts},
          {"kept_input", report.keptInput},
          {"before", toJson(report.before)},
          {"after", toJson(report.after)}};
}

std::string describeRepair(const RepairReport& report, double mergeDistance) {
  if (report.keptInput && report.before.watertight()) {
    return "the mesh is watertight: nothing to repair; it was written as it is\n" +
           describe(report.after);
  }
  if (report.keptInput) {
    return "no repair makes this mesh better" +
           std::string(mergeDistance > 0 ? " at this --merge distance: a smaller one may" : "") +
           "; it was written as it is\n" + describe(report.after);
  }
  return "merged " + formatCount(report.mergedVertices) + " vertices, dropped " +
         formatCount(report.unusedVertices) + " unused ones, " +
         formatCount(report.degenerateFaces) + " degenerate and " +
         formatCount(report.duplicateFaces) + " duplicate faces and " +
         formatCount(report.droppedParts) + " parts, split " + formatCount(report.splitVertices) +
         " vertices, filled " + formatCount(report.filledHoles) + " holes\n" +
         describe(report.after);
}

/// Judges a mesh as a reader of .stl has it, which knows vertices by their places alone: those that
/// touch are one, whatever was split.
void judgeWelded(const Mesh& mesh, const RepairArguments& arguments, RepairReport& report) {
  CheckOptions options;
  options.weld = true;
  options.threads = arguments.options.threads;
  options.progress = [](std::string_view /*stage*/, double /*fraction*/) { return !interrupted(); };
  const CheckReport welded = check(mesh, options);
  if (report.after.watertight() && !welded.watertight()) {
    printNote(shownFile(arguments.output) +
              " is not watertight: touching vertices are one in .stl; write .ply, .obj, .off or "
              ".glb");
  }
  report.after = welded;
}

int runRepair(const RepairArguments& arguments) {
  requireChecker();
  requireFile(arguments.output, "a repaired mesh");
  requireMeshEnding(arguments.output);
  requireDistinct(arguments.output, {arguments.input});
  requireWritable(arguments.output);
  const Mesh mesh = readMeshInput(arguments.input, arguments.format);
  RepairReport report;
  Mesh repaired;
  {
    ProgressBar bar(arguments.quiet);
    RepairOptions options = arguments.options;
    options.progress = bar.callback();
    repaired = repair(mesh, options, &report);
  }
  if (endingOf(arguments.output) == ".stl") judgeWelded(repaired, arguments, report);
  const double seconds = timed([&] { write(repaired, arguments.output); });
  if (arguments.json) {
    Json json = {{"file", arguments.input}, {"output", arguments.output}};
    json.update(repairJson(report));
    print(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(describeRepair(report, arguments.options.mergeDistance) +
          describeWritten({arguments.output}, seconds));
  }
  return report.after.watertight() ? kDone : kPromiseBroken;
}

}  // namespace

void addRepairCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<RepairArguments>();
  CLI::App* const repair = app.add_subcommand(
      "repair",
      checkerHelp("Make a mesh of another program watertight; exit code 1 if it is not then"));
  RepairOptions& options = arguments->options;
  repair
      ->add_option("MESH", arguments->input,
                   "a .ply, .obj, .stl, .off or .glb file, or - for standard input")
      ->required();
  repair
      ->add_option("-o,--output", arguments->output,
                   "the mesh to write: .ply (binary), .obj, .stl, .off, .glb, .usda or .3mf")
      ->required();
  addInputFormatOption(*repair, arguments->format);
  repair
      ->add_option("--merge", options.mergeDistance,
                   "vertices nearer than this, in the mesh's units, become one; 0: those at the "
                   "same place")
      ->capture_default_str();
  repair->add_option("--fill", options.fillEdges, "fill holes of up to that many edges; 0: none")
      ->capture_default_str();
  repair->add_flag("--drop-open", options.dropOpen,
                   "drop parts that are still open, if others are closed");
  addThreadsOption(*repair, options.threads);
  repair->add_flag("--json", arguments->json, "one JSON object on standard output");
  repair->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  repair->callback(
      [arguments, &chosen] { chosen = [arguments] { return runRepair(*arguments); }; });
}

}  // namespace tufa::tools
