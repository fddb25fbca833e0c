// What `tufa mesh` tells of a run.

#include <algorithm>
#include <nlohmann/json.hpp>

#include "attribute_options.h"
#include "console.h"
#include "mesh_run.h"
#include "paths.h"
#include "report.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

Json certificateJson(const Certificate& certificate) {
  return {{"max_error_voxels", certificate.maxErrorVoxels},
          {"mean_error_voxels", certificate.meanErrorVoxels},
          {"max_error_world", certificate.maxErrorWorld},
          {"euler_characteristic", certificate.eulerCharacteristic},
          {"smallest_angle_degrees", certificate.smallestAngle},
          {"triangles_under_min_angle", certificate.trianglesUnderMinAngle},
          {"leaf_levels", certificate.leafLevels},
          {"rounds", certificate.rounds}};
}

Json refinementJson(const Refinement& refinement) {
  return {{"rounds", refinement.rounds},
          {"added_vertices", refinement.addedVertices},
          {"largest_voxels", refinement.largestVoxels},
          {"triangles_left", refinement.trianglesLeft},
          {"crease_triangles", refinement.creaseTriangles}};
}

/// Adds the keys of one grid, times aside.
void addGrid(Json& json, const GridRun& run, const AttributeWords& words) {
  json["grid"] = run.grid;
  if (!run.united.empty()) json["union"] = run.united;
  json["output"] = run.output;
  json["isovalue"] = run.contour.isovalue;
  json["inside"] = run.contour.insideIsBelow ? "below" : "above";
  json["distance_field"] = run.contour.distanceField;
  if (!run.filters.reports.empty()) json["filters"] = toJson(run.filters);
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
  if (run.interfaces) {
    json["interfaces"] = {{"shared_vertices", run.interfaces->sharedVertices},
                          {"touching_vertices", run.interfaces->touchingVertices}};
  }
  if (!run.mesh.attributes.empty()) {
    json["attributes"] = toJson(run.mesh.attributes, words);
  }
  if (run.contour.certificate) json["certificate"] = certificateJson(*run.contour.certificate);
  if (run.contour.refinement) json["refinement"] = refinementJson(*run.contour.refinement);
}

Json secondsOf(const GridRun& run) {
  Json stages = Json::object();
  for (const StageTime& stage : run.contour.stages) stages[stage.stage] = stage.seconds;
  return {{"read", run.readSeconds},
          {"unite", run.uniteSeconds},
          {"filter", run.filters.seconds},
          {"contour", run.contourSeconds},
          {"attributes", run.attributeSeconds},
          {"check", run.checkSeconds},
          {"stages", stages}};
}

std::string describeCertificate(const Certificate& certificate) {
  std::string text = "within " + shortNumber(certificate.maxErrorVoxels) + " voxels (" +
                     shortNumber(certificate.maxErrorWorld) +
                     " world units) of the uniform mesh, " +
                     shortNumber(certificate.meanErrorVoxels) + " on average";
  if (!certificate.leafLevels.empty()) text += "; leaves of";
  for (std::size_t level = 0; level < certificate.leafLevels.size(); ++level) {
    text += (level == 0 ? " " : ", ") + std::to_string(std::size_t{1} << level) + ": " +
            formatCount(certificate.leafLevels[level]);
  }
  return text + "\n";
}

std::string describeUnion(const GridRun& run) {
  std::string names;
  for (const std::string& name : run.united) names += (names.empty() ? "" : ", ") + shownGrid(name);
  return "the union of " + names + ", made in " + shortNumber(run.uniteSeconds) + " s\n";
}

std::string describeRefinement(const Refinement& refinement) {
  std::string text = "refined in " + std::to_string(refinement.rounds) + " rounds: within " +
                     shortNumber(refinement.largestVoxels) +
                     " voxels of the trilinear surface at corners and middles";
  if (refinement.trianglesLeft > 0) {
    text += ", " + formatCount(refinement.trianglesLeft) + " triangles farther than asked for";
  }
  if (refinement.creaseTriangles > 0) {
    text += "; " + formatCount(refinement.creaseTriangles) +
            " left alone at corners off it, as on creases";
  }
  return text + "\n";
}

std::string describeGrid(const GridRun& run, double minAngle) {
  std::string text = shownGrid(run.grid) + ": " + formatCount(run.mesh.triangleCount()) +
                     " triangles (" + formatCount(run.mesh.quads.size()) + " quads), " +
                     formatCount(run.mesh.positions.size()) + " vertices from " +
                     formatCount(run.contour.activeVoxels) + " active voxels\n";
  text += "isovalue " + formatNumber(run.contour.isovalue) + ", inside is " +
          (run.contour.insideIsBelow ? "below" : "above") + "\n";
  text += "read " + shortNumber(run.readSeconds) + " s, contour " +
          shortNumber(run.contourSeconds) + " s" +
          (run.check ? ", check " + shortNumber(run.checkSeconds) + " s" : "") + "\n";
  if (!run.united.empty()) text += describeUnion(run);
  text += tools::describe(run.filters);
  if (run.contour.certificate) {
    const Certificate& certificate = *run.contour.certificate;
    text += describeCertificate(certificate);
    if (minAngle > 0) {
      text += describeAngles(certificate.smallestAngle, certificate.trianglesUnderMinAngle,
                             run.mesh.triangleCount(), minAngle) +
              "\n";
    }
  }
  if (run.contour.refinement) text += describeRefinement(*run.contour.refinement);
  if (!run.mesh.attributes.empty()) {
    text += "attributes: " + tools::describe(run.mesh.attributes) + ", sampled in " +
            shortNumber(run.attributeSeconds) + " s\n";
  }
  if (run.check) text += tools::describe(*run.check);
  return text;
}

std::vector<std::filesystem::path> filesOf(const MeshRun& run) {
  std::vector<std::filesystem::path> files;
  for (const GridRun& grid : run.grids) {
    if (std::find(files.begin(), files.end(), grid.output) == files.end()) {
      files.emplace_back(grid.output);
    }
  }
  return files;
}

}  // namespace

Json toJson(const MeshRun& run, const MeshArguments& arguments) {
  Json json;
  json["file"] = arguments.input;
  json["method"] = methodNames().at(static_cast<std::size_t>(arguments.method));
  const bool list = run.grids.size() > 1;
  if (list) {
    json["grids"] = Json::array();
    for (const GridRun& grid : run.grids) {
      Json one;
      addGrid(one, grid, arguments.attributes);
      one["seconds"] = secondsOf(grid);
      if (grid.check) one["check"] = toJson(*grid.check);
      json["grids"].push_back(std::move(one));
    }
    json["seconds"] = {{"write", run.writeSeconds}};
  } else {
    addGrid(json, run.grids.front(), arguments.attributes);
    json["seconds"] = secondsOf(run.grids.front());
    json["seconds"]["write"] = run.writeSeconds;
  }
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["threads"] = resolveThreads(arguments.contour.threads);
  if (!list && run.grids.front().check) json["check"] = toJson(*run.grids.front().check);
  return json;
}

std::string describe(const MeshRun& run, double minAngle) {
  std::string text;
  for (const GridRun& grid : run.grids) text += describeGrid(grid, minAngle);
  return text + describeWritten(filesOf(run), run.writeSeconds);
}

}  // namespace tufa::tools
