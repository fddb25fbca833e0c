// What `tufa compare` tells of a run.

#include <nlohmann/json.hpp>

#include "compare_run.h"
#include "console.h"
#include "report.h"
#include "standard_streams.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

Json truthJson(const TruthReport& truth) {
  Json json = {{"mesh_to_truth", toJson(truth.meshToTruth)}};
  if (truth.pointsToMesh.samples == 0) return json;
  json["creases_to_mesh"] = toJson(truth.pointsToMesh);
  json["creases_to_mesh"]["share_99"] = truth.pointsShare99;
  return json;
}

Json methodJson(const MethodResult& result) {
  Json json = {
      {"method", result.name}, {"seconds", result.seconds}, {"cpu_seconds", result.cpuSeconds}};
  json["extra_memory_bytes"] = result.extraBytes ? Json(*result.extraBytes) : Json(nullptr);
  json["check"] = toJson(result.check);
  // Components are of the shape more than of the method.
  json["check"].erase("component_list");
  json["check"].erase("component_list_complete");
  json["distance"] = toJson(result.distance);
  if (result.truth) json["truth"] = truthJson(*result.truth);
  return json;
}

/// The largest distance and the root mean square.
std::string describeSide(const DistanceSummary& side) {
  return side.samples == 0 ? "-" : shortNumber(side.largest) + " / " + shortNumber(side.rms);
}

/// "yes", or how many places are not as they should be.
std::string yesOrCount(bool holds, std::size_t count) {
  return holds ? "yes" : "no: " + formatCount(count);
}

std::string megabytes(const std::optional<std::uint64_t>& bytes) {
  return bytes ? shortNumber(static_cast<double>(*bytes) / 1e6) : "-";
}

bool hasCreases(const Comparison& comparison) {
  const auto& first = comparison.methods.front().truth;
  return first && first->pointsToMesh.samples > 0;
}

}  // namespace

Json toJson(const CompareRun& run, const CompareArguments& arguments) {
  const Comparison& all = run.comparison;
  Json json = {{"file", arguments.input}, {"grid", run.gridName}};
  json["outputs"] = arguments.outputs;
  json["isovalue"] = all.isovalue;
  json["inside"] = all.insideIsBelow ? "below" : "above";
  json["active_voxels"] = all.activeVoxels;
  json["voxel_size"] = all.voxelSize;
  json["trilinear_euler_characteristic"] = all.trilinearEuler;
  json["truth"] = arguments.truth ? Json(*arguments.truth) : Json(nullptr);
  json["differs_at"] = nullptr;
  if (all.differsAt) {
    json["differs_at"] = {{"point", {all.differsAt->x, all.differsAt->y, all.differsAt->z}},
                          {"difference_voxels", all.difference}};
  }
  json["methods"] = Json::array();
  for (const MethodResult& result : all.methods) json["methods"].push_back(methodJson(result));
  json["repeats"] = arguments.options.repeats;
  json["threads"] = resolveThreads(arguments.options.extract.contour.threads);
  json["seconds"] = run.seconds;
  return json;
}

TableRows tableOf(const Comparison& comparison) {
  TableRows rows = {{"method", "seconds", "MB", "vertices", "triangles", "closed", "manifold",
                     "pairs", "Euler (" + std::to_string(comparison.trilinearEuler) + ")",
                     "to surface", "from surface"}};
  const bool truth = comparison.methods.front().truth.has_value();
  const bool creases = hasCreases(comparison);
  if (truth) rows[0].emplace_back("to truth");
  if (creases) rows[0].emplace_back("creases, 99%");
  rows[0].insert(rows[0].end(), {"least angle", "under 10"});
  for (const MethodResult& result : comparison.methods) {
    const CheckReport& check = result.check;
    rows.push_back({result.name, shortNumber(result.seconds), megabytes(result.extraBytes),
                    formatCount(check.vertices), formatCount(check.triangles),
                    yesOrCount(check.closed, check.boundaryEdges),
                    yesOrCount(check.manifold, check.nonManifoldEdges + check.nonManifoldVertices),
                    formatCount(check.selfIntersectingPairs.value_or(0)),
                    std::to_string(check.eulerCharacteristic),
                    describeSide(result.distance.meshToSurface),
                    describeSide(result.distance.surfaceToMesh)});
    if (truth) rows.back().push_back(describeSide(result.truth->meshToTruth));
    if (creases) rows.back().push_back(shortNumber(result.truth->pointsShare99));
    rows.back().push_back(shortNumber(check.smallestAngleDegrees));
    rows.back().push_back(shortNumber(100 * check.shareUnder10Degrees) + "%");
  }
  return rows;
}

std::string summaryOf(const CompareRun& run, const CompareArguments& arguments) {
  const Comparison& all = run.comparison;
  return shownInput(arguments.input) + ", " + shownGrid(run.gridName) + ": " +
         formatCount(all.activeVoxels) + " active voxels of " + formatNumber(all.voxelSize) +
         " world units, isovalue " + formatNumber(all.isovalue) +
         ". Distances are in voxels, largest / rms; surface: the trilinear isosurface, of Euler "
         "characteristic " +
         std::to_string(all.trilinearEuler) + "; pairs: triangles that intersect.";
}

}  // namespace tufa::tools
