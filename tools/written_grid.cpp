#include "written_grid.h"

#include <nlohmann/json.hpp>

#include "console.h"
#include "paths.h"

namespace tufa::tools {

using Json = nlohmann::ordered_json;

std::string toJson(const WrittenGrid& written) {
  Json json;
  if (!written.input.empty()) json["file"] = written.input;
  json["output"] = written.output;
  json["grid"] = written.grid;
  if (!written.input.empty()) json["triangles"] = written.triangles;
  json["active_voxels"] = written.activeVoxels;
  json["voxel_size"] = written.voxelSize;
  json["seconds"] = {{"make", written.makeSeconds}, {"write", written.writeSeconds}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string describe(const WrittenGrid& written) {
  std::string text = shownGrid(written.grid) + ": " + formatCount(written.activeVoxels) +
                     " active voxels of " + formatNumber(written.voxelSize);
  if (!written.input.empty()) text += " from " + formatCount(written.triangles) + " triangles";
  return text + " in " + shortNumber(written.makeSeconds) + " s\n" +
         describeWritten({written.output}, written.writeSeconds);
}

}  // namespace tufa::tools
