#include "written_grid.h"

#include <tufa/io.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "console.h"
#include "paths.h"
#include "standard_streams.h"
#include "volume.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

std::string gridText(const WrittenGrid& written) {
  Json json;
  if (!written.input.empty()) json["file"] = written.input;
  json["output"] = written.output;
  json["grid"] = written.grid;
  if (written.mesh) {
    json["triangles"] = written.mesh->triangles;
    json["distances"] = written.mesh->distances == MeshDistances::Exact ? "exact" : "openvdb";
  }
  if (written.scene) {
    json["samples"] = written.scene->samples;
    json["hidden_voxels"] = written.scene->hiddenVoxels;
    json["undecided_voxels"] = written.scene->undecidedVoxels;
  }
  if (written.filters) json["filters"] = toJson(*written.filters);
  json["active_voxels"] = written.activeVoxels;
  json["voxel_size"] = written.voxelSize;
  json["seconds"] = {{written.filters ? "filter" : "make", written.makeSeconds},
                     {"write", written.writeSeconds}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string describeGrid(const WrittenGrid& written) {
  std::string text = written.filters ? describe(*written.filters) : "";
  text += shownGrid(written.grid) + ": " + formatCount(written.activeVoxels) +
          " active voxels of " + formatNumber(written.voxelSize);
  if (written.mesh) text += " from " + formatCount(written.mesh->triangles) + " triangles";
  if (written.scene) text += " from " + formatCount(written.scene->samples) + " samples";
  return text + " in " + shortNumber(written.makeSeconds) + " s\n" +
         describeWritten({written.output}, written.writeSeconds);
}

}  // namespace

void writeAndTell(const openvdb::GridBase::Ptr& grid, WrittenGrid written, Telling telling) {
  written.grid = grid->getName();
  written.activeVoxels = grid->activeVoxelCount();
  written.writeSeconds = timed([&] {
    if (isDirect(written.output)) {
      writeDirect(written.output, [&](std::ostream& stream) { writeGrids({grid}, stream); });
    } else {
      writeGrids({grid}, written.output);
    }
  });
  if (telling.json) {
    print(gridText(written));
  } else if (!telling.quiet) {
    print(describeGrid(written));
  }
}

}  // namespace tufa::tools
