#include <CLI/CLI.hpp>

#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "commands.h"
#include "console.h"
#include "filter_options.h"
#include "paths.h"
#include "progress_bar.h"
#include "standard_streams.h"
#include "volume.h"
#include "written_grid.h"

namespace tufa::tools {
namespace {

struct FilterArguments {
  std::string input;
  std::string output;
  std::optional<std::string> grid;
  FilterWords filters;
  std::optional<std::string> isovalue;
  ContourOptions meshing;  ///< what components are the inside of
  bool json = false;
  bool quiet = false;
};

/// Whether it matters which side of the surface is inside: to components, and to what NaN becomes.
bool needsInside(const FilterArguments& arguments) {
  const auto& words = arguments.filters.inOrder;
  return arguments.meshing.nonFinite == NonFinite::Outside ||
         std::any_of(words.begin(), words.end(), [](const FilterWord& word) {
           return word.option == "keep-largest" || word.option == "min-component";
         });
}

/// Throws Error(InvalidArgument) where there is no filter, or an isovalue or a side that nothing
/// depends on.
void requireFilters(const FilterArguments& arguments) {
  if (arguments.filters.inOrder.empty()) {
    throw Error(ErrorCode::InvalidArgument,
                "a filter is needed, such as --smooth mean or --keep-largest 1");
  }
  if (needsInside(arguments)) return;
  const bool asksInside = arguments.meshing.inside != Inside::Auto;
  if (arguments.isovalue || asksInside) {
    throw Error(ErrorCode::InvalidArgument,
                std::string(asksInside ? "--inside" : "--iso") +
                    " is for --keep-largest, --min-component and --nan outside: nothing else here "
                    "depends on it");
  }
}

/// The value on the surface. Throws Error(InvalidArgument) where a level set's 0 is not it and none
/// is given: filters do not tell which one they took.
std::optional<double> isovalueOf(const FilterArguments& arguments, const openvdb::GridBase& grid) {
  const auto value = readIsovalue(arguments.isovalue, grid, arguments.input);
  if (arguments.isovalue || describeGrid(grid).gridClass == "level set") return value;
  throw Error(ErrorCode::InvalidArgument,
              "grid \"" + nameOf(grid) + "\" in " + shownInput(arguments.input) +
                  " is no level set: --keep-largest, --min-component and --nan outside need --iso, "
                  "the value on the surface, or --iso auto for half way between the least and the "
                  "greatest one");
}

int runFilter(const FilterArguments& arguments) {
  keepApart(arguments.output);
  requireVolumeOutput(arguments.output);
  requireDistinct(arguments.output, {arguments.input});
  requireFilters(arguments);
  std::shared_ptr<openvdb::GridBase> grid = readVolume(arguments.input, arguments.grid);
  requireVoxels(*grid, arguments.input);
  ContourOptions meshing = arguments.meshing;
  if (needsInside(arguments)) meshing.isovalue = isovalueOf(arguments, *grid);
  FilterRun run;
  {
    ProgressBar bar(arguments.quiet);
    grid = filterVolume(grid, arguments.input, arguments.filters, meshing, bar, run);
  }
  requireLeft(*grid, arguments.input, run);
  if (!arguments.grid && !arguments.quiet) noteChoice(arguments.input, nameOf(*grid));
  ContourReport report;
  report.nonFiniteValues = run.nonFiniteValues();
  noteData(report);
  WrittenGrid written;
  written.input = arguments.input;
  written.output = arguments.output;
  written.voxelSize = voxelSizeOf(*grid);
  written.makeSeconds = run.seconds;
  written.filters = std::move(run);
  writeAndTell(grid, std::move(written), {arguments.json, arguments.quiet});
  return kDone;
}

}  // namespace

void addFilterCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<FilterArguments>();
  CLI::App* const filter =
      app.add_subcommand("filter", "Filter a volume and write what becomes of it");
  filter->add_option("FILE", arguments->input, "a .vdb file, or - for standard input")->required();
  filter
      ->add_option("-o,--output", arguments->output,
                   "the .vdb file to write, which has the filtered grid alone, or - for standard "
                   "output")
      ->required();
  filter->add_option("--grid", arguments->grid, "name of the grid; default: the first level set");
  addFilterOptions(*filter, arguments->filters);
  addIsovalueOption(*filter, arguments->isovalue);
  addInsideOption(*filter, arguments->meshing.inside);
  addNonFiniteOption(*filter, arguments->meshing.nonFinite);
  addThreadsOption(*filter, arguments->meshing.threads);
  filter->add_flag("--json", arguments->json, "one JSON object on standard output");
  filter->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  filter->callback([arguments, filter, &chosen] {
    chosen = [arguments, filter] {
      orderFilters(*filter, arguments->filters);
      return runFilter(*arguments);
    };
  });
}

}  // namespace tufa::tools
