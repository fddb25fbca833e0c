#include "report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "console.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostListedPieces = 100;

Json componentJson(const CheckComponent& piece) {
  return {{"vertices", piece.vertices},
          {"triangles", piece.triangles},
          {"euler_characteristic", piece.eulerCharacteristic},
          {"genus", piece.genus ? Json(*piece.genus) : Json(nullptr)}};
}

void addLine(std::string& text, const char* label, const std::string& value) {
  text += "  " + std::string(label) + value + "\n";
}

std::string describeGenus(const CheckReport& report) {
  if (report.components.empty()) return "";
  const auto& genus = report.components[0].genus;
  if (!genus) return "";
  return std::string(report.components.size() == 1 ? ", genus " : ", largest of genus ") +
         std::to_string(*genus);
}

/// The faults that there are, each with its count.
std::string listFaults(const CheckReport& report) {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + formatCount(count) + " " + what;
  };
  add(report.boundaryEdges, "boundary edges");
  add(report.boundaryLoops, "boundary loops");
  add(report.nonManifoldEdges, "non-manifold edges");
  add(report.nonManifoldVertices, "non-manifold vertices");
  add(report.misorientedEdges, "misoriented edges");
  add(report.invalidFaces, "invalid faces");
  add(report.degenerateFaces, "degenerate faces");
  add(report.duplicateFaces, "duplicate faces");
  add(report.selfIntersectingPairs.value_or(0), "intersecting pairs");
  return text.empty() ? "none" : text;
}

std::string describeSide(const DistanceSummary& side) {
  if (side.samples == 0) return "no samples";
  return shortNumber(side.largest) + " largest, " + shortNumber(side.mean) + " mean, " +
         shortNumber(side.rms) + " rms of " + formatCount(side.samples) + " samples";
}

}  // namespace

Json toJson(const CheckReport& report) {
  Json json;
  json["watertight"] = report.watertight();
  json["closed"] = report.closed;
  json["manifold"] = report.manifold;
  json["oriented"] = report.oriented;
  json["outward"] = report.outward;
  json["bounds_volume"] = report.boundsVolume;
  json["self_intersecting_pairs"] =
      report.selfIntersectingPairs ? Json(*report.selfIntersectingPairs) : Json(nullptr);
  json["vertices"] = report.vertices;
  json["unused_vertices"] = report.unusedVertices;
  json["triangles"] = report.triangles;
  json["boundary_edges"] = report.boundaryEdges;
  json["boundary_loops"] = report.boundaryLoops;
  json["non_manifold_edges"] = report.nonManifoldEdges;
  json["non_manifold_vertices"] = report.nonManifoldVertices;
  json["misoriented_edges"] = report.misorientedEdges;
  json["degenerate_faces"] = report.degenerateFaces;
  json["collapsed_faces"] = report.collapsedFaces;
  json["duplicate_faces"] = report.duplicateFaces;
  json["invalid_faces"] = report.invalidFaces;
  json["euler_characteristic"] = report.eulerCharacteristic;
  json["area"] = report.area;
  json["volume"] = report.volume;
  json["smallest_angle_degrees"] = report.smallestAngleDegrees;
  json["share_under_10_degrees"] = report.shareUnder10Degrees;
  json["components"] = report.components.size();
  json["component_list"] = Json::array();
  const std::size_t listed = std::min(report.components.size(), kMostListedPieces);
  for (std::size_t i = 0; i < listed; ++i) {
    json["component_list"].push_back(componentJson(report.components[i]));
  }
  json["component_list_complete"] = listed == report.components.size();
  json["seconds"] = report.seconds;
  return json;
}

Json toJson(const DistanceSummary& side) {
  return {
      {"samples", side.samples}, {"largest", side.largest}, {"mean", side.mean}, {"rms", side.rms}};
}

Json toJson(const DistanceReport& report) {
  Json json;
  json["mesh_to_surface"] = toJson(report.meshToSurface);
  json["surface_to_mesh"] = toJson(report.surfaceToMesh);
  json["isovalue"] = report.isovalue;
  json["voxel_size"] = report.voxelSize;
  json["seconds"] = report.seconds;
  return json;
}

std::string describe(const CheckReport& report) {
  const auto yesNo = [](bool value) { return std::string(value ? "yes" : "no"); };
  std::string text;
  addLine(
      text, "size             ",
      formatCount(report.vertices) + " vertices, " + formatCount(report.triangles) + " triangles");
  addLine(text, "pieces           ",
          formatCount(report.components.size()) + ", Euler characteristic " +
              std::to_string(report.eulerCharacteristic) + describeGenus(report));
  addLine(text, "area, volume     ",
          formatNumber(report.area) + ", " + formatNumber(report.volume));
  addLine(text, "smallest angle   ",
          shortNumber(report.smallestAngleDegrees) + " degrees, " +
              shortNumber(100 * report.shareUnder10Degrees) + "% of triangles under 10");
  addLine(text, "closed           ", yesNo(report.closed));
  addLine(text, "manifold         ", yesNo(report.manifold));
  addLine(text, "oriented         ",
          yesNo(report.oriented) + (report.outward ? ", outward" : ", not outward"));
  addLine(text, "bounds a volume  ", yesNo(report.boundsVolume));
  addLine(text, "faults           ", listFaults(report));
  addLine(text, "watertight       ", yesNo(report.watertight()));
  return text;
}

std::string describe(const DistanceReport& report) {
  std::string text;
  addLine(text, "mesh to surface  ", describeSide(report.meshToSurface));
  addLine(text, "surface to mesh  ", describeSide(report.surfaceToMesh));
  addLine(text, "in voxels of     ",
          formatNumber(report.voxelSize) + ", at isovalue " + formatNumber(report.isovalue));
  return text;
}

}  // namespace tufa::tools
