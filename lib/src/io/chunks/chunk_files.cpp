// Writes the meshes of a chunk.

#include <tufa/chunks.h>
#include <tufa/error.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/known_enum.h"
#include "base/single_precision.h"
#include "io/checksum.h"
#include "io/chunks/chunk_parts.h"
#include "io/gltf/glb.h"
#include "io/mesh/mesh_format.h"
#include "io/output_file.h"

namespace tufa {
namespace {

using io::kChunkParts;
using io::glb::Floats;
using io::glb::Json;

/// Numbers as they are in memory, one after another.
class Bytes {
 public:
  template <class Number>
  void add(Number value) {
    std::array<char, sizeof(Number)> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    bytes_.append(bytes.data(), bytes.size());
  }
  void add(const Floats& floats) {
    for (const float x : floats) add(x);
  }
  void pad() { bytes_.resize((bytes_.size() + 3) / 4 * 4); }
  [[nodiscard]] const std::string& text() const { return bytes_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

 private:
  std::string bytes_;
};

/// A file and the checksum of what goes into it.
class SummedFile {
 public:
  explicit SummedFile(const std::filesystem::path& path) : file_(path) {}

  void write(std::string_view bytes) {
    checksum_.add(bytes);
    file_.write(bytes.data(), bytes.size());
  }
  /// Gives the file its name; its checksum.
  [[nodiscard]] std::string commit() {
    file_.commit();
    return checksum_.text();
  }

 private:
  io::OutputFile file_;
  io::Checksum checksum_;
};

std::size_t triangleCount(const ChunkLevel& level) {
  std::size_t count = 0;
  for (std::size_t part = 0; part < kChunkParts; ++part) count += io::partOf(level, part).size();
  return count;
}

/// A .glb while it is built: its document and its binary data.
class GlbBuilder {
 public:
  GlbBuilder(const ChunkIndex& index, const ChunkLevel& level) : index_(index), level_(level) {}

  /// One mesh under one node, a primitive for each part that has triangles.
  void build(const Chunk& chunk, std::size_t number) {
    const std::string name = io::chunkName(chunk.index, number);
    const Position& origin = index_.origin;
    json_["scenes"] = Json::array({{{"nodes", {0}}}});
    json_["nodes"] = Json::array(
        {{{"name", name},
          {"mesh", 0},
          {"translation", {origin.x, origin.y, origin.z}},
          {"extras",
           {{"chunk", {chunk.index[0], chunk.index[1], chunk.index[2]}}, {"level", number}}}}});
    const Json attributes = {{"POSITION", addPositions()}, {"NORMAL", addNormals()}};
    json_["meshes"] = Json::array({{{"name", name}, {"primitives", addPrimitives(attributes)}}});
    json_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
  }

  void write(SummedFile& file) const {
    file.write(io::glb::head(json_, binary_.size()));
    file.write(binary_.text());
  }

 private:
  std::size_t addView(std::size_t begin, int target) {
    return io::glb::add(json_, "bufferViews",
                        {{"buffer", 0},
                         {"byteOffset", begin},
                         {"byteLength", binary_.size() - begin},
                         {"target", target}});
  }

  std::size_t addPositions() {
    constexpr float kMost = std::numeric_limits<float>::infinity();
    Floats least{kMost, kMost, kMost}, greatest{-kMost, -kMost, -kMost};
    for (const Position& p : level_.positions) {
      const Floats place{static_cast<float>(p.x - index_.origin.x),
                         static_cast<float>(p.y - index_.origin.y),
                         static_cast<float>(p.z - index_.origin.z)};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        least[axis] = std::min(least[axis], place[axis]);
        greatest[axis] = std::max(greatest[axis], place[axis]);
      }
      binary_.add(place);
    }
    return io::glb::add(json_, "accessors",
                        {{"bufferView", addView(0, io::glb::kArrayBuffer)},
                         {"componentType", io::glb::kFloat},
                         {"count", level_.positions.size()},
                         {"type", "VEC3"},
                         {"min", least},
                         {"max", greatest}});
  }

  std::size_t addNormals() {
    const std::size_t begin = binary_.size();
    for (const Normal& n : level_.normals) binary_.add(io::glb::unitNormal(n));
    return io::glb::add(json_, "accessors",
                        {{"bufferView", addView(begin, io::glb::kArrayBuffer)},
                         {"componentType", io::glb::kFloat},
                         {"count", level_.normals.size()},
                         {"type", "VEC3"}});
  }

  Json addPrimitives(const Json& attributes) {
    const bool isShort = level_.positions.size() <= io::glb::kMostShortVertices;
    const std::size_t begin = binary_.size();
    Json primitives = Json::array();
    for (std::size_t part = 0; part < kChunkParts; ++part) {
      const std::vector<Triangle>& triangles = io::partOf(level_, part);
      if (triangles.empty()) continue;
      const std::size_t accessor = io::glb::add(
          json_, "accessors",
          {{"bufferView", 2},
           {"byteOffset", binary_.size() - begin},
           {"componentType", isShort ? io::glb::kUnsignedShort : io::glb::kUnsignedInt},
           {"count", 3 * triangles.size()},
           {"type", "SCALAR"}});
      for (const Triangle& triangle : triangles) addIndices(triangle, isShort);
      primitives.push_back({{"attributes", attributes},
                            {"indices", accessor},
                            {"mode", 4},
                            {"extras", {{"name", io::partName(part)}}}});
    }
    addView(begin, io::glb::kElementArrayBuffer);
    binary_.pad();
    return primitives;
  }

  void addIndices(const Triangle& triangle, bool isShort) {
    for (const VertexIndex vertex : triangle.vertices) {
      if (isShort) {
        binary_.add(static_cast<std::uint16_t>(vertex));
      } else {
        binary_.add(vertex);
      }
    }
  }

  const ChunkIndex& index_;
  const ChunkLevel& level_;
  Json json_ = io::glb::emptyDocument();
  Bytes binary_;
};

std::string plyHeader(const ChunkLevel& level, bool precise) {
  const std::string scalar = precise ? "double" : "float";
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment written by tufa\n";
  header += "element vertex " + std::to_string(level.positions.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) header += "property " + scalar + " " + axis + "\n";
  for (const char* axis : {"nx", "ny", "nz"})
    header += std::string("property float ") + axis + "\n";
  header += "element face " + std::to_string(triangleCount(level)) + "\n";
  return header + "property list uchar int vertex_indices\nproperty uchar part\nend_header\n";
}

void writePly(const ChunkLevel& level, SummedFile& file) {
  const bool precise = !std::all_of(level.positions.begin(), level.positions.end(),
                                    [](const Position& p) { return p == base::toSingle(p); });
  Bytes bytes;
  for (std::size_t i = 0; i < level.positions.size(); ++i) {
    const Position& p = level.positions[i];
    for (const double x : {p.x, p.y, p.z}) {
      if (precise) {
        bytes.add(x);
      } else {
        bytes.add(static_cast<float>(x));
      }
    }
    const Normal& n = level.normals[i];
    bytes.add(Floats{n.x, n.y, n.z});
  }
  for (std::size_t part = 0; part < kChunkParts; ++part) {
    for (const Triangle& triangle : io::partOf(level, part)) {
      bytes.add(std::uint8_t{3});
      for (const VertexIndex vertex : triangle.vertices) bytes.add(vertex);
      bytes.add(static_cast<std::uint8_t>(part));
    }
  }
  file.write(plyHeader(level, precise));
  file.write(bytes.text());
}

}  // namespace

std::vector<ChunkFile> writeChunk(const ChunkIndex& index, const Chunk& chunk,
                                  const std::string& folder, ChunkFormat format) {
  base::requireKnown(format, ChunkFormat::Ply, "the format of chunks");
  std::vector<ChunkFile> files;
  for (std::size_t number = 0; number < chunk.levels.size(); ++number) {
    const ChunkLevel& level = chunk.levels[number];
    ChunkFile& made = files.emplace_back();
    if (triangleCount(level) == 0) continue;
    made.name = io::chunkName(chunk.index, number) + (format == ChunkFormat::Glb ? ".glb" : ".ply");
    SummedFile file(std::filesystem::path(folder) / made.name);
    if (format == ChunkFormat::Glb) {
      GlbBuilder builder(index, level);
      builder.build(chunk, number);
      builder.write(file);
    } else {
      writePly(level, file);
    }
    made.checksum = file.commit();
  }
  return files;
}

}  // namespace tufa
