// What `tufa chunks` tells of a run.

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "chunks_run.h"
#include "console.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

/// The sums over all chunks at one LOD.
struct LevelSum {
  std::size_t interior = 0;
  std::size_t regular = 0;
  std::size_t transition = 0;
  std::size_t pairsLeft = 0;
  double maxErrorVoxels = 0;
  double transitionErrorVoxels = 0;
  double smallestAngle = 180;  ///< degrees
  std::size_t trianglesUnderMinAngle = 0;
};

LevelSum sumOf(const ChunkIndex& index, std::size_t level) {
  LevelSum sum;
  for (const ChunkEntry& chunk : index.chunks) {
    const ChunkLevelEntry& entry = chunk.levels[level];
    sum.interior += entry.interiorTriangles;
    sum.regular += entry.regularTriangles;
    sum.transition += entry.transitionTriangles;
    sum.pairsLeft += entry.intersectionsLeft;
    sum.maxErrorVoxels = std::max(sum.maxErrorVoxels, entry.maxErrorVoxels);
    sum.smallestAngle = std::min(sum.smallestAngle, entry.smallestAngle);
    sum.trianglesUnderMinAngle += entry.trianglesUnderMinAngle;
    sum.transitionErrorVoxels = std::max(sum.transitionErrorVoxels, entry.transitionErrorVoxels);
  }
  return sum;
}

std::string describeAttributes(const ChunksRun& run) {
  if (run.attributes.empty()) return "";
  return ", attributes " + tools::describe(run.attributes) + " " +
         shortNumber(run.attributeSeconds) + " s";
}

}  // namespace

Json toJson(const ChunksRun& run, const ChunksArguments& arguments) {
  Json json;
  json["file"] = arguments.input;
  json["grid"] = run.index.grid;
  json["output"] = arguments.output;
  json["isovalue"] = run.contour.isovalue;
  json["inside"] = run.contour.insideIsBelow ? "below" : "above";
  json["active_voxels"] = run.contour.activeVoxels;
  json["non_finite_values"] = run.contour.nonFiniteValues;
  if (!run.filters.reports.empty()) json["filters"] = toJson(run.filters);
  json["voxel_size"] = run.index.voxelSize;
  json["chunk_size"] = run.index.chunkSize;
  json["step"] = run.index.step;
  json["chunks"] = run.index.chunks.size();
  if (!run.attributes.empty()) {
    json["attributes"] = toJson(run.attributes, arguments.attributes);
  }
  json["levels"] = Json::array();
  for (std::size_t level = 0; level < run.index.tolerances.size(); ++level) {
    const LevelSum sum = sumOf(run.index, level);
    json["levels"].push_back(
        {{"level", level},
         {"tolerance_voxels", run.index.tolerances[level]},
         {"triangles",
          {{"interior", sum.interior}, {"regular", sum.regular}, {"transition", sum.transition}}},
         {"max_error_voxels", sum.maxErrorVoxels},
         {"transition_error_voxels", sum.transitionErrorVoxels},
         {"smallest_angle_degrees", sum.smallestAngle},
         {"triangles_under_min_angle", sum.trianglesUnderMinAngle},
         {"pairs_left", sum.pairsLeft}});
  }
  json["seconds"] = {{"read", run.readSeconds},
                     {"filter", run.filters.seconds},
                     {"build", run.buildSeconds},
                     {"attributes", run.attributeSeconds},
                     {"write", run.writeSeconds}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["threads"] = resolveThreads(arguments.chunks.contour.threads);
  return json;
}

std::string describe(const ChunksRun& run, const ChunksArguments& arguments) {
  std::string text = tools::describe(run.filters) + shownGrid(run.index.grid) + ": " +
                     formatCount(run.index.chunks.size()) + " chunks of " +
                     std::to_string(run.index.chunkSize) + " voxels from " +
                     formatCount(run.contour.activeVoxels) + " active voxels\n";
  for (std::size_t level = 0; level < run.index.tolerances.size(); ++level) {
    const LevelSum sum = sumOf(run.index, level);
    text += "level " + std::to_string(level) + ": " + formatCount(sum.interior + sum.regular) +
            " triangles, of which " + formatCount(sum.regular) + " in strips, and " +
            formatCount(sum.transition) + " in strips to coarser chunks; within " +
            shortNumber(sum.maxErrorVoxels) + " voxels";
    if (const double asked = arguments.chunks.contour.minAngle; asked > 0) {
      text += "; " + describeAngles(sum.smallestAngle, sum.trianglesUnderMinAngle,
                                    sum.interior + sum.regular, asked);
    }
    if (sum.pairsLeft > 0) {
      text += "; " + formatCount(sum.pairsLeft) + " intersecting pairs of triangles";
    }
    text += "\n";
  }
  std::size_t files = 1;  // chunks.json
  for (const ChunkEntry& chunk : run.index.chunks) {
    files += static_cast<std::size_t>(
        std::count_if(chunk.levels.begin(), chunk.levels.end(),
                      [](const ChunkLevelEntry& level) { return !level.file.empty(); }));
  }
  return text + "read " + shortNumber(run.readSeconds) + " s, build " +
         shortNumber(run.buildSeconds) + " s" + describeAttributes(run) + "\nwrote " +
         formatCount(files) + (files == 1 ? " file to " : " files to ") +
         shownFile(arguments.output) + ", in " + shortNumber(run.writeSeconds) + " s\n";
}

}  // namespace tufa::tools
