#include <CLI/CLI.hpp>

#include <tufa/advise.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "file_list.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct AdviseArguments {
  std::vector<std::string> inputs;
  std::optional<std::string> grid;
  std::optional<std::string> isovalue;
  AdviseOptions options;
  bool json = false;
  bool quiet = false;
};

Json samplingJson(const SamplingReport& report) {
  return {{"isovalue", report.isovalue},
          {"inside", report.insideIsBelow ? "below" : "above"},
          {"distance_field", report.distanceField},
          {"voxel_size", report.voxelSize},
          {"surface_cells", report.surfaceCells},
          {"sharp_cells", report.sharpCells},
          {"thin_smooth_cells", report.thinSmooth},
          {"thin_sharp_cells", report.thinSharp},
          {"thin_sheet_cells", report.thinSheets},
          {"unresolved_kinks", report.unresolvedKinks},
          {"spared_cells", report.sparedCells},
          {"hidden_sheets", report.hiddenSheets},
          {"reach_voxels", report.reachVoxels},
          {"least_voxels", report.leastVoxels},
          {"spared_voxels", report.sparedVoxels},
          {"middle_voxels", report.middleVoxels},
          {"highest_frequency", report.highestFrequency},
          {"nyquist", report.nyquist},
          {"voxel_size_needed", report.voxelSizeNeeded},
          {"enough", report.enough()}};
}

/// "1,234 cells (5.6%)".
std::string shareOf(std::size_t cells, std::size_t all) {
  const double share = all > 0 ? static_cast<double>(cells) / static_cast<double>(all) : 0;
  return formatCount(cells) + " cells (" + shortNumber(100 * share) + "%)";
}

/// A size, of which those of larger features are not known.
std::string sizeText(double voxels, const SamplingReport& report) {
  return (voxels < report.reachVoxels ? "" : "over ") + shortNumber(voxels) + " voxels";
}

/// What a grid that is not fine enough misses.
std::string whyNotEnough(const SamplingReport& report) {
  std::string text;
  const auto add = [&](bool misses, const char* what) {
    if (misses) text += (text.empty() ? "" : ", and ") + std::string(what);
  };
  add(report.voxelSizeNeeded < report.voxelSize, "features are too thin");
  add(report.unresolvedKinks > report.sparedCells, "cells have more than one crease");
  add(report.hiddenSheets > 0, "sheets are hidden between samples");
  return text;
}

std::string describeSampling(const SamplingReport& report, const AdviseOptions& options) {
  std::string text;
  const auto line = [&text](const char* label, const std::string& value) {
    text += "  " + std::string(label) + value + "\n";
  };
  const std::size_t cells = report.surfaceCells;
  const std::size_t smooth = cells - report.sharpCells;
  line("surface          ",
       formatCount(cells) + " cells, " + shareOf(report.sharpCells, cells) + " with creases");
  if (cells > 0) {
    line("features         ", "smallest " + sizeText(report.leastVoxels, report) + ", all but " +
                                  shortNumber(100 * options.spared) + "% at least " +
                                  sizeText(report.sparedVoxels, report) + ", half of them " +
                                  sizeText(report.middleVoxels, report));
  }
  line("smooth, too thin ", "under " + shortNumber(options.smoothVoxels) + " voxels: " +
                                shareOf(report.thinSmooth, smooth) + " of the smooth ones");
  line("sharp, too thin  ", "under " + shortNumber(options.sharpVoxels) +
                                " voxels: " + shareOf(report.thinSharp, report.sharpCells) +
                                " of those with creases");
  line("thin sheets      ", "under " + shortNumber(options.sheetVoxels) +
                                " voxels: " + shareOf(report.thinSheets, cells));
  line("kinks            ", shareOf(report.unresolvedKinks, cells) + " with more than one crease");
  line("hidden sheets    ", report.distanceField ? formatCount(report.hiddenSheets) + " edges"
                                                 : "not known: values are no distances");
  if (cells > 0) {
    line("frequency        ", shortNumber(report.highestFrequency) +
                                  " radians a world unit, samples hold " +
                                  shortNumber(report.nyquist));
  }
  line("voxel size       ", formatNumber(report.voxelSize) +
                                (report.voxelSizeNeeded < report.voxelSize
                                     ? ", it would take " + shortNumber(report.voxelSizeNeeded)
                                     : ""));
  line("fine enough      ", report.enough() ? "yes" : "no, as " + whyNotEnough(report));
  return text;
}

int adviseFile(const std::string& file, const AdviseArguments& arguments, FileList& files) {
  const auto grid = readVolume(file, arguments.grid);
  requireVoxels(*grid, file);
  AdviseOptions options = arguments.options;
  options.contour.isovalue = readIsovalue(arguments.isovalue, *grid, file);
  SamplingReport report;
  {
    ProgressBar bar(arguments.quiet);
    options.contour.progress = bar.callback();
    report = adviseSampling(*grid, options);
  }
  if (report.surfaceCells == 0) requireSurface(Mesh(), report.isovalue, *grid, file);
  if (!arguments.quiet) {
    noteIsovalue(arguments.isovalue, *grid, report.isovalue);
    if (!arguments.grid) noteChoice(file, nameOf(*grid));
  }
  if (arguments.json) {
    Json json = {{"file", file}, {"grid", nameOf(*grid)}};
    json.update(samplingJson(report));
    files.add(std::move(json));
  } else if (!arguments.quiet) {
    print(shownInput(file) + ", " + shownGrid(nameOf(*grid)) + "\n" +
          describeSampling(report, options));
  }
  return report.enough() ? kDone : kPromiseBroken;
}

int runAdvise(const AdviseArguments& arguments) {
  FileList files(arguments.inputs, arguments.json);
  files.forEach([&](const std::string& file) { return adviseFile(file, arguments, files); });
  return files.finish();
}

}  // namespace

void addAdviseCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<AdviseArguments>();
  CLI::App* const advise = app.add_subcommand(
      "advise", "Say whether a volume is fine enough for its features; exit code 1 if it is not");
  AdviseOptions& options = arguments->options;
  advise->add_option("FILE", arguments->inputs, "a .vdb file, or several; - for standard input")
      ->required();
  advise->add_option("--grid", arguments->grid, "name of the grid; default: the first level set");
  addIsovalueOption(*advise, arguments->isovalue);
  advise->add_option("--smooth", options.smoothVoxels, "voxels that smooth features should have")
      ->capture_default_str();
  advise
      ->add_option("--sharp", options.sharpVoxels, "voxels that features with creases should have")
      ->capture_default_str();
  advise->add_option("--sheet", options.sheetVoxels, "voxels under which a feature is a thin sheet")
      ->capture_default_str();
  advise
      ->add_option("--sharp-angle", options.sharpAngle,
                   "normals in a cell that differ by more, in degrees, mean a crease")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  advise
      ->add_option(
          "--spare", options.spared,
          "share of the cells, those with the smallest features, that may go without, and share "
          "that may have more than one crease")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  addNonFiniteOption(*advise, options.contour.nonFinite);
  addThreadsOption(*advise, options.contour.threads);
  advise->add_flag("--json", arguments->json, "one JSON object on standard output");
  advise->add_flag("--quiet", arguments->quiet, "no text, only the exit code");
  advise->callback(
      [arguments, &chosen] { chosen = [arguments] { return runAdvise(*arguments); }; });
}

}  // namespace tufa::tools
