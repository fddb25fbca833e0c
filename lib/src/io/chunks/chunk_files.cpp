// Writes the meshes of a chunk.

#include <tufa/chunk_files.h>
#include <tufa/chunks.h>
#include <tufa/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "base/checksum.h"
#include "base/known_enum.h"
#include "base/require_chunk.h"
#include "base/single_precision.h"
#include "io/chunks/chunk_parts.h"
#include "io/gltf/glb_document.h"
#include "io/mesh/file_attributes.h"
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
  [[nodiscard]] const std::string& text() const { return bytes_; }

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
  base::Checksum checksum_;
};

std::size_t triangleCount(const ChunkLevel& level) {
  std::size_t count = 0;
  for (std::size_t part = 0; part < kChunkParts; ++part) count += io::partOf(level, part).size();
  return count;
}

/// Whether positions are stored as whole numbers of steps.
bool isOnLattice(const ChunkIndex& index) { return index.compression != GlbCompression::None; }

/// All parts of a level as one list of triangles; `parts` gets the numbers of their indices.
Mesh meshOf(const ChunkLevel& level, std::vector<std::size_t>& parts) {
  Mesh mesh;
  mesh.positions = level.positions;
  mesh.normals = level.normals;
  mesh.attributes = level.attributes;
  for (std::size_t part = 0; part < kChunkParts; ++part) {
    const std::vector<Triangle>& triangles = io::partOf(level, part);
    mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
    parts.push_back(3 * triangles.size());
  }
  return mesh;
}

/// One vertex for each of the level's.
shading::ShadedMesh shadedOf(const Mesh& mesh) {
  shading::ShadedMesh shaded;
  shaded.sources.resize(mesh.positions.size());
  std::iota(shaded.sources.begin(), shaded.sources.end(), VertexIndex{0});
  shaded.normals = mesh.normals;
  for (const Triangle& t : mesh.triangles) {
    shaded.indices.insert(shaded.indices.end(), t.vertices.begin(), t.vertices.end());
  }
  return shaded;
}

std::array<double, 3> turnedOf(const Position& p, UpAxis up) {
  return io::turned({p.x, p.y, p.z}, up);
}

/// How the positions of a level are stored: counted from the index's origin, or, on its lattice,
/// from a place of it at the level's least corner. Throws Error(InvalidArgument) for positions off
/// the lattice.
io::GlbFrame frameOf(const ChunkIndex& index, const ChunkLevel& level,
                     const io::GlbPacking& packing) {
  if (!isOnLattice(index)) {
    return io::floatFrame(turnedOf(index.origin, packing.up), 1, packing);
  }
  std::array<double, 3> least{}, greatest{};
  least.fill(std::numeric_limits<double>::infinity());
  greatest.fill(-std::numeric_limits<double>::infinity());
  for (const Position& p : level.positions) {
    const std::array<double, 3> place = turnedOf(p, packing.up);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double steps = std::round(place[axis] / index.step);
      if (steps * index.step + 0.0 != place[axis] + 0.0) {
        throw Error(ErrorCode::InvalidArgument,
                    "a vertex of a chunk is not on the lattice of its index");
      }
      least[axis] = std::min(least[axis], steps);
      greatest[axis] = std::max(greatest[axis], steps);
    }
  }
  io::GlbFrame frame;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (greatest[axis] - least[axis] > io::kMostShort) {
      throw Error(ErrorCode::InvalidArgument, "16 bits do not hold a chunk on its lattice");
    }
    frame.origin[axis] = least[axis] * index.step;
    frame.translation[axis] = least[axis] * (index.step * index.scale) + 0.0;
  }
  frame.factor = 1 / index.step;
  frame.nodeScale = index.step * index.scale;
  frame.quantized = true;
  return frame;
}

/// One mesh under one node, a primitive for each part that has triangles.
void writeGlb(const ChunkIndex& index, const Chunk& chunk, std::size_t number, SummedFile& file) {
  const ChunkLevel& level = chunk.levels[number];
  const io::GlbPacking packing{index.compression, index.up, index.scale};
  std::vector<std::size_t> parts;
  const Mesh mesh = meshOf(level, parts);
  shading::ShadedMesh shaded = shadedOf(mesh);
  if (isOnLattice(index)) shading::orderForGraphics(shaded, parts);
  io::GlbStreams streams = io::encodeIn(frameOf(index, level, packing), mesh, shaded, packing);
  io::GlbDocument document(index.compression);
  const Json vertices = document.addVertices(streams, mesh.attributes);
  Json primitives = document.addParts(vertices, streams.indices, parts);
  std::size_t part = 0;
  for (Json& primitive : primitives) {
    while (parts[part] == 0) ++part;
    primitive["extras"]["name"] = io::partName(part++);
  }
  const std::size_t node = document.addMesh(
      {io::chunkName(chunk.index, number), std::move(primitives), mesh.attributes}, streams.frame,
      {{"chunk", {chunk.index[0], chunk.index[1], chunk.index[2]}}, {"level", number}});
  document.json()["scenes"][0]["nodes"].push_back(node);
  document.write([&](std::string_view bytes) { file.write(bytes); });
}

std::string plyHeader(const ChunkLevel& level, bool precise) {
  const std::string scalar = precise ? "double" : "float";
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment written by tufa\n";
  header += "element vertex " + std::to_string(level.positions.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) header += "property " + scalar + " " + axis + "\n";
  for (const char* axis : {"nx", "ny", "nz"})
    header += std::string("property float ") + axis + "\n";
  header += io::plyProperties(level.attributes);
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
    for (const Attribute& attribute : level.attributes) {
      io::forPlyValues(attribute, i, [&](auto value) { bytes.add(value); });
    }
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
    base::requireSound(chunk, number);
    io::requireSoundAttributes(level.attributes, level.positions.size(),
                               format == ChunkFormat::Glb);
    made.name = io::chunkName(chunk.index, number) + (format == ChunkFormat::Glb ? ".glb" : ".ply");
    SummedFile file(std::filesystem::path(folder) / made.name);
    if (format == ChunkFormat::Glb) {
      writeGlb(index, chunk, number, file);
    } else {
      writePly(level, file);
    }
    made.checksum = file.commit();
  }
  return files;
}

}  // namespace tufa
