// Reads the meshes of a chunk back.

#include <tufa/chunk_files.h>
#include <tufa/chunks.h>
#include <tufa/error.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "base/checksum.h"
#include "io/chunks/chunk_parts.h"
#include "io/gltf/glb_file.h"
#include "io/gltf/glb_streams.h"
#include "io/mesh/mesh_format.h"
#include "io/mesh/mesh_readers.h"

namespace tufa {
namespace {

/// Where the positions in a file lie in the world: whole numbers of steps from a place of the
/// lattice, or world units from the index's origin; y up.
struct Placement {
  std::array<double, 3> begin{};  ///< steps or world units
  double step = 1;
  UpAxis up = UpAxis::Y;

  [[nodiscard]] Position worldOf(const Vec3& p) const {
    const std::array<double, 3> place{step * (begin[0] + p[0]), step * (begin[1] + p[1]),
                                      step * (begin[2] + p[2])};
    const auto world = io::turnedBack(place, up);
    return {world[0], world[1], world[2]};
  }
};

Placement placementOf(const ChunkIndex& index, const nlohmann::json& node,
                      const io::InputBytes& input) {
  const bool isOnLattice = index.compression != GlbCompression::None;
  Placement placement{{}, isOnLattice ? index.step : 1, index.up};
  const std::array<double, 3> one{1, 1, 1}, none{0, 0, 0};
  const auto scale = node.value("scale", one);
  const auto translation = node.value("translation", none);
  const double metres = placement.step * index.scale;
  if (scale != std::array<double, 3>{metres, metres, metres}) {
    input.fail("its scale is not that of chunks.json");
  }
  placement.begin = io::turned({index.origin.x, index.origin.y, index.origin.z}, index.up);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (isOnLattice) placement.begin[axis] = std::round(translation[axis] / metres);
    if (translation[axis] != metres * placement.begin[axis]) {
      input.fail("its origin is not that of chunks.json");
    }
  }
  return placement;
}

void readGlb(const ChunkIndex& index, const io::InputBytes& input, ChunkLevel& level) {
  io::glb::File file(input);
  const nlohmann::json& node = file.document().at("nodes").at(0);
  const Placement placement = placementOf(index, node, input);
  const nlohmann::json& primitives = file.document().at("meshes").at(0).at("primitives");
  const nlohmann::json& attributes = primitives.at(0).at("attributes");
  const auto forEachPoint = [&](const char* attribute, const auto& add) {
    const io::glb::View view = file.viewOf(attributes.at(attribute), "VEC3", 3);
    for (std::size_t n = 0; n < view.count; ++n) {
      const Vec3 point = file.pointAt(view, n);
      if (!point.isFinite()) input.fail("vertex " + std::to_string(n) + " is not finite");
      add(point);
    }
  };
  forEachPoint("POSITION", [&](const Vec3& p) { level.positions.push_back(placement.worldOf(p)); });
  forEachPoint("NORMAL", [&](const Vec3& n) {
    const auto normal = io::turnedBack({n[0], n[1], n[2]}, index.up);
    level.normals.emplace_back(static_cast<float>(normal[0]), static_cast<float>(normal[1]),
                               static_cast<float>(normal[2]));
  });
  for (const nlohmann::json& primitive : primitives) {
    const auto name = primitive.at("extras").at("name").get<std::string>();
    const std::size_t part = io::partNamed(name);
    if (part == io::kChunkParts)
      input.fail("it has an unknown part \"" + name.substr(0, 40) + "\"");
    if (primitive.at("attributes") != attributes) input.fail("its parts do not share vertices");
    const auto corners = file.indicesOf(primitive.at("indices"), level.positions.size());
    for (std::size_t n = 0; n + 2 < corners.size(); n += 3) {
      io::partOf(level, part).emplace_back(corners[n], corners[n + 1], corners[n + 2]);
    }
  }
}

void readPly(const io::InputBytes& input, ChunkLevel& level) {
  std::vector<std::uint8_t> parts;
  Mesh mesh = io::readPly(input, &parts);
  if (!mesh.quads.empty() || parts.size() != mesh.triangles.size()) {
    input.fail("its faces are not triangles with a part each");
  }
  level.positions = std::move(mesh.positions);
  level.normals = std::move(mesh.normals);
  for (std::size_t n = 0; n < parts.size(); ++n) {
    if (parts[n] >= io::kChunkParts) {
      input.fail("it has an unknown part " + std::to_string(parts[n]));
    }
    io::partOf(level, parts[n]).push_back(mesh.triangles[n]);
  }
}

/// Throws Error(UnreadableFile) for links out of the folder: a folder of chunks from elsewhere
/// opens no other file of whoever reads it.
void requireInside(const std::filesystem::path& path, const std::filesystem::path& folder) {
  std::error_code error;
  const auto file = std::filesystem::canonical(path, error);
  if (error) return;  // which reading it tells
  if (file.parent_path() == std::filesystem::canonical(folder, error)) return;
  throw Error(ErrorCode::UnreadableFile,
              "cannot read " + path.string() + ": it is a link out of the folder of chunks");
}

/// Throws Error(UnreadableFile) if the file is another one than chunks.json lists.
void requireListed(const ChunkLevelEntry& entry, const io::InputBytes& input) {
  if (entry.checksum.empty()) return;  // of a program that knows none
  base::Checksum checksum;
  checksum.add(input.view());
  if (checksum.text() == entry.checksum) return;
  input.fail("it has another checksum than chunks.json says: it is damaged, or of another run");
}

/// Whether the sizes of a mesh are those in chunks.json.
bool matches(const ChunkLevel& level, const ChunkLevelEntry& entry) {
  const auto sizeOf = [](const auto& strips) {
    std::size_t count = 0;
    for (const auto& strip : strips) count += strip.size();
    return count;
  };
  return level.positions.size() == entry.vertices && level.normals.size() == entry.vertices &&
         level.interior.size() == entry.interiorTriangles &&
         sizeOf(level.regular) == entry.regularTriangles &&
         sizeOf(level.transition) == entry.transitionTriangles;
}

ChunkLevel readLevel(const ChunkIndex& index, const ChunkLevelEntry& entry,
                     const std::string& folder) {
  ChunkLevel level;
  level.maxErrorVoxels = entry.maxErrorVoxels;
  level.transitionErrorVoxels = entry.transitionErrorVoxels;
  const bool isEmpty =
      entry.interiorTriangles + entry.regularTriangles + entry.transitionTriangles == 0;
  if (entry.file.empty() && isEmpty) return level;
  if (entry.file.empty()) {
    throw Error(ErrorCode::UnreadableFile,
                "cannot read a chunk: " + io::chunkIndexFile(folder).string() + " names no file");
  }
  const std::filesystem::path path = std::filesystem::path(folder) / entry.file;
  requireInside(path, folder);
  const io::InputBytes input(path);
  requireListed(entry, input);
  if (path.extension() == ".ply") {
    readPly(input, level);
  } else {
    try {
      readGlb(index, input, level);
    } catch (const nlohmann::json::exception& error) {
      input.fail(std::string("its JSON is damaged: ") + error.what());
    }
  }
  if (!matches(level, entry)) input.fail("it has other counts than chunks.json says");
  return level;
}

}  // namespace

Chunk readChunk(const ChunkIndex& index, std::size_t chunk, const std::string& folder) {
  if (chunk >= index.chunks.size()) {
    throw Error(ErrorCode::InvalidArgument, "there is no chunk " + std::to_string(chunk) +
                                                " among " + std::to_string(index.chunks.size()));
  }
  const ChunkEntry& entry = index.chunks[chunk];
  Chunk read;
  read.index = entry.index;
  for (const ChunkLevelEntry& level : entry.levels) {
    read.levels.push_back(readLevel(index, level, folder));
  }
  return read;
}

}  // namespace tufa
