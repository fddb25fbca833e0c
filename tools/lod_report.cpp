// What `tufa lod` tells of a run.

#include <nlohmann/json.hpp>

#include "attribute_options.h"
#include "console.h"
#include "lod_run.h"
#include "paths.h"
#include "report.h"
#include "text_table.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

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
  json["smallest_angle_degrees"] = lod.certificate.smallestAngle;
  json["triangles_under_min_angle"] = lod.certificate.trianglesUnderMinAngle;
  json["screen_coverage"] = lod.screenCoverage;
  json["pairs_left"] = lod.intersectionsLeft;
  if (run.dropping) json["dropped"] = droppedToJson(lod);
  json["seconds"] = lod.seconds;
  if (!run.checks.empty()) json["check"] = toJson(run.checks[level]);
  return json;
}

}  // namespace

Json toJson(const LodRun& run, const LodArguments& arguments) {
  Json json;
  json["file"] = arguments.input;
  json["grid"] = run.gridName;
  json["outputs"] = Json::array();
  for (const auto& file : run.written.files) json["outputs"].push_back(file.string());
  json["isovalue"] = run.contour.isovalue;
  json["inside"] = run.contour.insideIsBelow ? "below" : "above";
  if (!run.filters.reports.empty()) json["filters"] = toJson(run.filters);
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
  json["seconds"] = {{"read", run.readSeconds},     {"filter", run.filters.seconds},
                     {"chain", run.chainSeconds},   {"attributes", run.attributeSeconds},
                     {"check", run.checkSeconds},   {"write", run.writeSeconds},
                     {"report", run.reportSeconds}, {"shared", run.chain.sharedSeconds}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["threads"] = resolveThreads(arguments.lod.contour.threads);
  return json;
}

std::vector<std::vector<std::string>> tableOf(const LodRun& run, double minAngle) {
  std::vector<std::vector<std::string>> rows = {{"level", "triangles", "error (voxels)",
                                                 "error (world)", "smallest angle", "coverage",
                                                 "seconds"}};
  if (minAngle > 0) rows[0].push_back("under " + shortNumber(minAngle) + " degrees");
  if (run.dropping) rows[0].push_back("dropped");
  if (!run.checks.empty()) rows[0].push_back("watertight");
  for (std::size_t level = 0; level < run.chain.levels.size(); ++level) {
    const Lod& lod = run.chain.levels[level];
    rows.push_back({std::to_string(level), formatCount(lod.mesh.triangleCount()),
                    shortNumber(lod.certificate.maxErrorVoxels),
                    shortNumber(lod.certificate.maxErrorWorld),
                    shortNumber(lod.certificate.smallestAngle), shortNumber(lod.screenCoverage),
                    shortNumber(lod.seconds)});
    if (minAngle > 0) {
      rows.back().push_back(
          formatShare(lod.certificate.trianglesUnderMinAngle, lod.mesh.triangleCount()));
    }
    if (run.dropping) rows.back().push_back(formatCount(lod.dropped.size()));
    if (!run.checks.empty()) rows.back().push_back(run.checks[level].watertight() ? "yes" : "no");
  }
  return rows;
}

std::string describe(const LodRun& run, const LodArguments& arguments) {
  std::string text = shownGrid(run.gridName) + ": " + formatCount(run.contour.activeVoxels) +
                     " active voxels, isovalue " + formatNumber(run.contour.isovalue) + "\n" +
                     tools::describe(run.filters) +
                     layOut(tableOf(run, arguments.lod.contour.minAngle));
  text += "read " + shortNumber(run.readSeconds) + " s, chain " + shortNumber(run.chainSeconds) +
          " s (of which all levels share " + shortNumber(run.chain.sharedSeconds) + " s)";
  if (!run.chain.levels.empty() && !run.chain.levels[0].mesh.attributes.empty()) {
    text += ", attributes " + tools::describe(run.chain.levels[0].mesh.attributes) + " " +
            shortNumber(run.attributeSeconds) + " s";
  }
  if (!run.checks.empty()) text += ", check " + shortNumber(run.checkSeconds) + " s";
  if (arguments.report) text += ", report " + shortNumber(run.reportSeconds) + " s";
  std::vector<std::filesystem::path> files = run.written.files;
  if (arguments.report) files.emplace_back(*arguments.report);
  return text + "\n" + describeWritten(files, run.writeSeconds);
}

}  // namespace tufa::tools
