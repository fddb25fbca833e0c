#include "lod_run.h"

#include <tufa/error.h>
#include <tufa/io.h>
#include <memory>

#include "checker.h"
#include "console.h"
#include "lod_page.h"
#include "progress_bar.h"
#include "report.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

LodOptions chainOptions(const LodArguments& arguments, const ContourOptions& meshing,
                        const openvdb::GridBase& grid, ProgressBar& bar) {
  LodOptions options = arguments.lod;
  options.contour = meshing;
  options.contour.tolerance = readTolerance("--tolerance", arguments.tolerance, grid);
  for (const std::string& text : arguments.tolerances) {
    options.tolerances.push_back(readTolerance("--tolerances", text, grid));
  }
  if (arguments.toleranceGrid) {
    options.contour.toleranceGrid = readToleranceGrid(arguments.input, *arguments.toleranceGrid);
  }
  options.contour.progress = bar.callback();
  return options;
}

/// The levels, and the uniform mesh where there is to be a report.
void buildChain(const LodArguments& arguments, ProgressBar& bar, LodRun& run) {
  std::shared_ptr<openvdb::GridBase> grid;
  run.readSeconds = timed([&] { grid = readVolume(arguments.input, arguments.grid); });
  run.gridName = nameOf(*grid);
  if (!arguments.allowEmpty) requireVoxels(*grid, arguments.input);
  ContourOptions meshing = arguments.lod.contour;
  meshing.isovalue = readIsovalue(arguments.isovalue, *grid, arguments.input);
  grid = filterVolume(grid, arguments.input, arguments.filters, meshing, bar, run.filters);
  if (!arguments.allowEmpty) requireLeft(*grid, arguments.input, run.filters);
  const LodOptions options = chainOptions(arguments, meshing, *grid, bar);
  run.dropping = options.allowTopologyChange;
  run.chainSeconds = timed([&] { run.chain = buildLods(*grid, options, &run.contour); });
  run.contour.nonFiniteValues += run.filters.nonFiniteValues();
  if (run.chain.levels.empty() && !run.chain.stopped.empty()) {
    throw Error(ErrorCode::InvalidArgument, run.chain.stopped);
  }
  if (!arguments.quiet) {
    noteIsovalue(arguments.isovalue, *grid, run.contour.isovalue);
    if (!arguments.grid) noteChoice(arguments.input, run.gridName);
  }
  if (!arguments.allowEmpty) {
    requireSurface(run.chain.levels.empty() ? Mesh() : run.chain.levels[0].mesh,
                   run.contour.isovalue, *grid, arguments.input, run.filters.text());
  }
  if (!arguments.report) return;
  ContourOptions uniform = options.contour;
  uniform.uniform = true;
  uniform.progress = bar.callback();
  run.reportSeconds = timed([&] { run.reference = contour(*grid, uniform); });
}

void sampleAttributes(const LodArguments& arguments, const AttributeGrids& attributes,
                      LodRun& run) {
  if (arguments.attributes.empty()) return;
  run.attributeSeconds = timed([&] {
    for (Lod& lod : run.chain.levels) {
      lod.mesh.attributes = attributes.sample(lod.mesh.positions, arguments.lod.contour.threads);
    }
  });
}

void checkLevels(const LodArguments& arguments, ProgressBar& bar, LodRun& run) {
  if (!arguments.check) return;
  CheckOptions options;
  options.threads = arguments.lod.contour.threads;
  run.checkSeconds = timed([&] {
    const Progress progress = bar.callback();
    const auto count = static_cast<double>(run.chain.levels.size());
    for (std::size_t level = 0; level < run.chain.levels.size(); ++level) {
      options.progress = [&](std::string_view stage, double fraction) {
        return progress(stage, (static_cast<double>(level) + fraction) / count);
      };
      run.checks.push_back(check(run.chain.levels[level].mesh, options));
    }
  });
}

void writeLevels(const LodArguments& arguments, ProgressBar& bar, LodRun& run) {
  LodWriteOptions options = arguments.writing;
  options.threads = arguments.lod.contour.threads;
  options.progress = bar.callback();
  run.writeSeconds = timed([&] {
    if (isDirect(arguments.output)) {
      const MeshFormat format = meshFormat(arguments.output, arguments.format);
      writeDirect(arguments.output, [&](std::ostream& stream) {
        writeLods(run.chain, stream, format, options, &run.written);
      });
      run.written.files.emplace_back(arguments.output);
    } else {
      writeLods(run.chain, arguments.output, options, &run.written);
    }
  });
}

/// Of the calls that a run makes: how long each is likely to take.
std::vector<double> callShares(const LodArguments& arguments) {
  std::vector<double> shares;
  if (!arguments.filters.inOrder.empty()) shares.push_back(kFilterShare);
  shares.push_back(kContourShare);
  if (arguments.report) shares.push_back(0.2 * kContourShare);  // the uniform mesh
  if (arguments.check) shares.push_back(kCheckShare);
  shares.push_back(kWriteShare);
  if (arguments.report) shares.push_back(kCheckShare);  // pictures
  return shares;
}

void writeReport(const LodRun& run, const LodArguments& arguments, ProgressBar& bar) {
  LodPage page;
  page.title = arguments.writing.name + ": levels of detail";
  page.summary = shownInput(arguments.input) +
                 (run.gridName.empty() ? "" : ", grid " + run.gridName) + ", " +
                 formatCount(run.contour.activeVoxels) + " active voxels of " +
                 formatNumber(run.chain.voxelSize) +
                 " world units. Errors are distances to the uniform mesh of the grid.";
  if (!run.chain.stopped.empty()) page.summary += " Note: " + run.chain.stopped + ".";
  page.rows = tableOf(run, arguments.lod.contour.minAngle);
  page.headings = page.rows.front();
  page.rows.erase(page.rows.begin());
  page.yUp = arguments.writing.up == UpAxis::Y;
  page.threads = arguments.lod.contour.threads;
  page.progress = bar.callback();
  writeLodPage(run.chain, run.reference, page, *arguments.report);
}

}  // namespace

LodRun makeLods(const LodArguments& arguments) {
  ProgressBar bar(arguments.quiet, callShares(arguments));
  LodRun run;
  const AttributeGrids attributes(arguments.input, arguments.attributes);
  buildChain(arguments, bar, run);
  sampleAttributes(arguments, attributes, run);
  checkLevels(arguments, bar, run);
  writeLevels(arguments, bar, run);
  if (arguments.report) {
    run.reportSeconds += timed([&] { writeReport(run, arguments, bar); });
  }
  return run;
}

}  // namespace tufa::tools
