#include <CLI/CLI.hpp>

#include <tufa/check.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "checker.h"
#include "commands.h"
#include "console.h"
#include "progress_bar.h"
#include "report.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

struct MeshArguments {
  std::string input;
  std::string output;
  std::optional<std::string> grid;
  ContourOptions contour;
  std::string tolerance = "0.1";
  std::optional<std::string> toleranceGrid;
  bool check = false;
  bool json = false;
  bool quiet = false;
};

/// What one run found and how long its parts took.
struct MeshRun {
  std::string gridName;
  Mesh mesh;
  ContourReport contour;
  std::optional<CheckReport> check;
  double readSeconds = 0;
  double contourSeconds = 0;
  double checkSeconds = 0;
  double writeSeconds = 0;
};

MeshRun runStages(const MeshArguments& arguments) {
  ProgressBar bar(arguments.quiet);
  MeshRun run;
  std::shared_ptr<openvdb::GridBase> grid;
  run.readSeconds = timed([&] { grid = readVolume(arguments.input, arguments.grid); });
  run.gridName = nameOf(*grid);
  requireVoxels(*grid, arguments.input);

  ContourOptions contourOptions = arguments.contour;
  contourOptions.tolerance = readTolerance("--tolerance", arguments.tolerance, *grid);
  if (arguments.toleranceGrid) {
    contourOptions.toleranceGrid = readToleranceGrid(arguments.input, *arguments.toleranceGrid);
  }
  contourOptions.progress = bar.callback();
  run.contourSeconds = timed([&] { run.mesh = contour(*grid, contourOptions, &run.contour); });
  requireSurface(run.mesh, run.contour.isovalue, *grid, arguments.input);
  grid.reset();

  if (arguments.check) {
    CheckOptions checkOptions;
    checkOptions.threads = arguments.contour.threads;
    checkOptions.progress = bar.callback();
    run.checkSeconds = timed([&] { run.check = check(run.mesh, checkOptions); });
  }
  WriteOptions writeOptions;
  if (!run.gridName.empty()) writeOptions.name = run.gridName;
  writeOptions.progress = bar.callback();
  run.writeSeconds = timed([&] { write(run.mesh, arguments.output, writeOptions); });
  return run;
}

Json runToJson(const MeshRun& run, const MeshArguments& arguments) {
  Json json;
  json["file"] = arguments.input;
  json["grid"] = run.gridName;
  json["output"] = arguments.output;
  json["isovalue"] = run.contour.isovalue;
  json["inside"] = run.contour.insideIsBelow ? "below" : "above";
  json["distance_field"] = run.contour.distanceField;
  json["active_voxels"] = run.contour.activeVoxels;
  json["non_finite_values"] = run.contour.nonFiniteValues;
  json["surface_cells"] = run.contour.surfaceCells;
  json["crease_cells"] = run.contour.creaseCells;
  json["open_edges"] = run.contour.openEdges;
  json["face_flips"] = run.contour.faceFlips;
  json["repair"] = {{"pairs_found", run.contour.intersectionsFound},
                    {"pairs_left", run.contour.intersectionsLeft},
                    {"moved_vertices", run.contour.movedVertices},
                    {"flipped_diagonals", run.contour.flippedDiagonals},
                    {"fanned_quads", run.contour.fannedQuads}};
  json["vertices"] = run.mesh.positions.size();
  json["triangles"] = run.mesh.triangleCount();
  json["quads"] = run.mesh.quads.size();
  if (run.contour.certificate) {
    const Certificate& certificate = *run.contour.certificate;
    json["certificate"] = {{"max_error_voxels", certificate.maxErrorVoxels},
                           {"mean_error_voxels", certificate.meanErrorVoxels},
                           {"max_error_world", certificate.maxErrorWorld},
                           {"euler_characteristic", certificate.eulerCharacteristic},
                           {"leaf_levels", certificate.leafLevels},
                           {"rounds", certificate.rounds}};
  }
  Json stages = Json::object();
  for (const StageTime& stage : run.contour.stages) stages[stage.stage] = stage.seconds;
  json["seconds"] = {{"read", run.readSeconds},
                     {"contour", run.contourSeconds},
                     {"check", run.checkSeconds},
                     {"write", run.writeSeconds},
                     {"stages", stages}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["threads"] = resolveThreads(arguments.contour.threads);
  if (run.check) json["check"] = toJson(*run.check);
  return json;
}

std::string describeCertificate(const Certificate& certificate) {
  std::string text = "within " + formatNumber(certificate.maxErrorVoxels) + " voxels (" +
                     formatNumber(certificate.maxErrorWorld) +
                     " world units) of the uniform mesh, " +
                     formatNumber(certificate.meanErrorVoxels) + " on average; leaves of";
  for (std::size_t level = 0; level < certificate.leafLevels.size(); ++level) {
    text += (level == 0 ? " " : ", ") + std::to_string(std::size_t{1} << level) + ": " +
            formatCount(certificate.leafLevels[level]);
  }
  return text + "\n";
}

std::string summary(const MeshRun& run, const MeshArguments& arguments) {
  const double total = run.readSeconds + run.contourSeconds + run.checkSeconds + run.writeSeconds;
  std::string text = arguments.output + ": " + formatCount(run.mesh.triangleCount()) +
                     " triangles (" + formatCount(run.mesh.quads.size()) + " quads), " +
                     formatCount(run.mesh.positions.size()) + " vertices from " +
                     formatCount(run.contour.activeVoxels) + " active voxels\n";
  text += "isovalue " + formatNumber(run.contour.isovalue) + ", inside is " +
          (run.contour.insideIsBelow ? "below" : "above") + "\n";
  text += formatNumber(total) + " s: read " + formatNumber(run.readSeconds) + ", contour " +
          formatNumber(run.contourSeconds) + ", check " + formatNumber(run.checkSeconds) +
          ", write " + formatNumber(run.writeSeconds) + "\n";
  if (run.contour.certificate) text += describeCertificate(*run.contour.certificate);
  if (run.check) text += describe(*run.check);
  return text;
}

int runMesh(const MeshArguments& arguments) {
  // Errors that are certain now are reported before the work is done.
  if (arguments.check) requireChecker();
  requireMeshEnding(arguments.output);
  requireWritable(arguments.output);
  const MeshRun run = runStages(arguments);
  noteData(run.contour);
  const bool broken = run.check && !run.check->watertight();
  if (broken) noteBroken(*run.check, run.contour, "the mesh");
  if (arguments.json) {
    print(runToJson(run, arguments).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  } else if (!arguments.quiet) {
    print(summary(run, arguments));
  }
  return broken ? kPromiseBroken : kDone;
}

void addAdaptiveOptions(CLI::App& app, MeshArguments& arguments) {
  ContourOptions& options = arguments.contour;
  app.add_option("--tolerance", arguments.tolerance,
                 "largest distance to the uniform mesh, in voxels, or with the suffix w in world "
                 "units")
      ->capture_default_str();
  app.add_option("--max-angle", options.maxAngle,
                 "largest angle between the normals in one cell, in degrees")
      ->capture_default_str();
  app.add_option("--min-cell", options.minCell,
                 "size in voxels up to which cells are merged whatever the tolerance")
      ->capture_default_str();
  app.add_option("--max-cell", options.maxCell, "size in voxels of the largest cells");
  app.add_option("--tolerance-grid", arguments.toleranceGrid,
                 "float grid of the file that multiplies the tolerance in space");
  app.add_flag("--uniform", options.uniform, "do not merge cells");
}

}  // namespace

void addMeshCommand(CLI::App& app, Command& chosen) {
  const auto arguments = std::make_shared<MeshArguments>();
  CLI::App* const mesh = app.add_subcommand("mesh", "Mesh the surface of a volume");
  mesh->add_option("FILE", arguments->input, "a .vdb file")->required();
  mesh->add_option("-o,--output", arguments->output,
                   "the mesh to write: .ply (binary), .obj, .stl, .off or .glb")
      ->required();
  mesh->add_option("--grid", arguments->grid, "name of the grid; default: the first level set");
  addAdaptiveOptions(*mesh, *arguments);
  addContourOptions(*mesh, arguments->contour);
  mesh->add_flag("--check", arguments->check,
                 checkerHelp("check the mesh; exit 1 if it is not watertight"));
  mesh->add_flag("--json", arguments->json, "one JSON object on standard output");
  mesh->add_flag("--quiet", arguments->quiet, "no summary and no progress bar");
  mesh->callback([arguments, &chosen] { chosen = [arguments] { return runMesh(*arguments); }; });
}

}  // namespace tufa::tools
