// chunks.json: what is known of all chunks without their meshes.

#include <tufa/chunk_files.h>
#include <tufa/chunks.h>
#include <tufa/error.h>
#include <tufa/memory.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "io/chunks/chunk_parts.h"
#include "io/input_bytes.h"
#include "io/json_input.h"
#include "io/output_file.h"

namespace tufa {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;
/// By the numbers of GlbCompression.
constexpr std::array<std::string_view, 3> kCompressions{"none", "quantized", "meshopt"};
/// By the numbers of AttributeRole.
constexpr std::array<std::string_view, 3> kRoles{"value", "colour", "motion"};
constexpr std::size_t kMostWidth = 4;

Json toJson(const Position& p) { return Json::array({p.x, p.y, p.z}); }

Json toJson(const ChunkLevelEntry& level) {
  return {{"file", level.file},
          {"checksum", level.checksum},
          {"vertices", level.vertices},
          {"triangles",
           {{"interior", level.interiorTriangles},
            {"regular", level.regularTriangles},
            {"transition", level.transitionTriangles}}},
          {"bounds", {{"min", toJson(level.least)}, {"max", toJson(level.greatest)}}},
          {"max_error_voxels", level.maxErrorVoxels},
          {"transition_error_voxels", level.transitionErrorVoxels},
          {"pairs_left", level.intersectionsLeft}};
}

Json toJson(const ChunkIndex& index, std::size_t number) {
  const ChunkEntry& chunk = index.chunks[number];
  Json json;
  json["index"] = {chunk.index[0], chunk.index[1], chunk.index[2]};
  for (int face = 0; face < kChunkFaces; ++face) {
    json["neighbours"].push_back(index.neighbour(number, face));
  }
  for (const ChunkLevelEntry& level : chunk.levels) json["levels"].push_back(toJson(level));
  return json;
}

Json toJson(const std::vector<Attribute>& attributes) {
  Json json = Json::array();
  for (const Attribute& attribute : attributes) {
    json.push_back({{"name", attribute.name},
                    {"width", attribute.width},
                    {"role", kRoles.at(static_cast<std::size_t>(attribute.role))}});
  }
  return json;
}

/// All but the chunks.
Json headOf(const ChunkIndex& index) {
  return {{"tufa_chunks", kVersion},
          {"grid", index.grid},
          {"chunk_size", index.chunkSize},
          {"tolerances_voxels", index.tolerances},
          {"voxel_size", index.voxelSize},
          {"transform", index.transform},
          {"origin", toJson(index.origin)},
          {"crease_angle", index.creaseAngle},
          {"compression", kCompressions.at(static_cast<std::size_t>(index.compression))},
          {"step", index.step},
          {"up", index.up == UpAxis::Z ? "z" : "y"},
          {"metres_per_unit", index.scale},
          {"attributes", toJson(index.attributes)},
          {"surface", index.surface}};
}

std::string textOf(const Json& json) {
  // A name may hold bytes that are not UTF-8; JSON may not.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Converts JSON to an index, and refuses what no index contains.
class IndexReader {
 public:
  explicit IndexReader(const io::InputBytes& input) : input_(input) {}

  ChunkIndex read() const {
    const Json json = io::parseJson<Json>(input_.view(), input_);
    if (!json.is_object() || !json.contains("tufa_chunks")) input_.fail("it is no list of chunks");
    if (json["tufa_chunks"] != kVersion) {
      input_.fail("its version is " + textOf(json["tufa_chunks"]).substr(0, 40) + ", not " +
                  std::to_string(kVersion));
    }
    ChunkIndex index;
    index.grid = json.at("grid").get<std::string>();
    index.chunkSize = readChunkSize(json.at("chunk_size"));
    for (const Json& tolerance : json.at("tolerances_voxels")) {
      index.tolerances.push_back(error(tolerance));
    }
    require(!index.tolerances.empty(), "it has no levels");
    index.voxelSize = number(json.at("voxel_size"));
    if (!(index.voxelSize > 0)) input_.fail("the size of voxels is not above 0");
    require(json.at("transform").size() == 4, "the transform has not four rows");
    for (std::size_t row = 0; row < 4; ++row) {
      require(json["transform"][row].size() == 4, "the transform has not four columns");
      for (std::size_t k = 0; k < 4; ++k)
        index.transform[row][k] = number(json["transform"][row][k]);
    }
    index.origin = position(json.at("origin"));
    readPacking(json, index);
    for (const Json& chunk : json.at("chunks")) addChunk(chunk, index);
    return index;
  }

 private:
  void require(bool holds, const char* cause) const {
    if (!holds) input_.fail(cause);
  }

  [[nodiscard]] double number(const Json& json) const {
    require(json.is_number() && std::isfinite(json.get<double>()), "a number is missing");
    return json.get<double>();
  }

  [[nodiscard]] double error(const Json& json) const {
    const double value = number(json);
    require(value >= 0, "an error is below 0");
    return value;
  }

  [[nodiscard]] std::size_t count(const Json& json) const { return io::countIn(json, input_); }

  [[nodiscard]] int readChunkSize(const Json& json) const {
    const std::size_t size = count(json);
    require(size >= 8 && size <= 1024 && (size & (size - 1)) == 0,
            "the size of chunks is no power of two from 8 to 1024");
    return static_cast<int>(size);
  }

  [[nodiscard]] Position position(const Json& json) const {
    require(json.is_array() && json.size() == 3, "a point has not three coordinates");
    return {number(json[0]), number(json[1]), number(json[2])};
  }

  [[nodiscard]] Coord coordinates(const Json& json) const {
    require(json.is_array() && json.size() == 3, "an index has not three numbers");
    Coord index;
    for (int axis = 0; axis < 3; ++axis) {
      const Json& place = json[static_cast<std::size_t>(axis)];
      constexpr double kMost = 1 << 29;  // chunks of 8 reach all of index space
      const double number = place.is_number_integer() ? place.get<double>() : 2.0 * kMost;
      require(std::abs(number) <= kMost, "an index is no integer of the lattice");
      index[axis] = place.get<int>();
    }
    return index;
  }

  [[nodiscard]] ChunkLevelEntry level(const Json& json) const {
    ChunkLevelEntry entry;
    entry.file = json.at("file").get<std::string>();
    // Nothing outside the folder is ever opened.
    require(entry.file.find('/') == std::string::npos && entry.file != "." && entry.file != ".." &&
                entry.file.find('\0') == std::string::npos,
            "a file is not named by its name alone");
    entry.checksum = json.value("checksum", "");
    entry.vertices = count(json.at("vertices"));
    entry.interiorTriangles = count(json.at("triangles").at("interior"));
    entry.regularTriangles = count(json["triangles"].at("regular"));
    entry.transitionTriangles = count(json["triangles"].at("transition"));
    entry.least = position(json.at("bounds").at("min"));
    entry.greatest = position(json["bounds"].at("max"));
    entry.maxErrorVoxels = error(json.at("max_error_voxels"));
    entry.transitionErrorVoxels = error(json.at("transition_error_voxels"));
    entry.intersectionsLeft = count(json.at("pairs_left"));
    return entry;
  }

  // Where keys are missing: as files were before there were these.
  void readPacking(const Json& json, ChunkIndex& index) const {
    index.creaseAngle = json.value("crease_angle", 180.0);
    const auto known = json.value("compression", std::string(kCompressions.front()));
    const auto* const found = std::find(kCompressions.begin(), kCompressions.end(), known);
    require(found != kCompressions.end(), "its compression is unknown");
    index.compression = static_cast<GlbCompression>(found - kCompressions.begin());
    index.step = json.value("step", 0.0);
    require(index.compression == GlbCompression::None || index.step > 0, "it has no step");
    const auto up = json.value("up", std::string("y"));
    require(up == "y" || up == "z", "what is up is neither y nor z");
    index.up = up == "z" ? UpAxis::Z : UpAxis::Y;
    index.scale = json.value("metres_per_unit", 1.0);
    require(index.scale > 0, "its metres are not above 0");
    if (json.contains("attributes")) readAttributes(json["attributes"], index);
    index.surface = json.value("surface", "");
  }

  void readAttributes(const Json& json, ChunkIndex& index) const {
    require(json.is_array(), "its attributes are no list");
    for (const Json& each : json) {
      Attribute& attribute = index.attributes.emplace_back();
      attribute.name = each.at("name").get<std::string>();
      const std::size_t width = count(each.at("width"));
      require(width >= 1 && width <= kMostWidth, "an attribute has no width from 1 to 4");
      attribute.width = static_cast<int>(width);
      const auto role = each.at("role").get<std::string>();
      const auto* const found = std::find(kRoles.begin(), kRoles.end(), role);
      require(found != kRoles.end(), "the role of an attribute is unknown");
      attribute.role = static_cast<AttributeRole>(found - kRoles.begin());
    }
  }

  void addChunk(const Json& json, ChunkIndex& index) const {
    ChunkEntry chunk;
    chunk.index = coordinates(json.at("index"));
    require(index.chunks.empty() || index.chunks.back().index < chunk.index,
            "the chunks are not sorted by index");
    for (const Json& entry : json.at("levels")) chunk.levels.push_back(level(entry));
    require(chunk.levels.size() == index.tolerances.size() && !chunk.levels.empty(),
            "a chunk has not one level for each tolerance");
    index.chunks.push_back(std::move(chunk));
  }

  const io::InputBytes& input_;
};

// What a file says.
ChunkIndex indexIn(const io::InputBytes& input) {
  try {
    return IndexReader(input).read();
  } catch (const Json::exception& error) {
    input.fail(std::string("its JSON is damaged: ") + error.what());
  }
}

}  // namespace

void writeChunkIndex(const ChunkIndex& index, const std::string& folder) {
  std::string text = textOf(headOf(index));
  text.back() = ',';
  text += "\"chunks\":[";
  for (std::size_t i = 0; i < index.chunks.size(); ++i) {
    text += (i == 0 ? "\n" : ",\n") + textOf(toJson(index, i));
  }
  text += "]}\n";
  try {
    (void)indexIn(io::InputBytes(FileBytes{text, "the index of chunks"}));
  } catch (const Error& error) {
    throw Error(ErrorCode::InvalidArgument,
                std::string("no file is written that could not be read again: ") + error.what());
  }
  io::OutputFile file(io::chunkIndexFile(folder));
  file.write(text.data(), text.size());
  file.commit();
}

ChunkIndex readChunkIndex(const std::string& folder) {
  return indexIn(io::InputBytes(io::chunkIndexFile(folder)));
}

}  // namespace tufa
