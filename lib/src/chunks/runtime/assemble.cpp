#include <tufa/chunks.h>
#include <tufa/error.h>

#include <algorithm>
#include <map>

#include "base/vertex_welder.h"
#include "chunks/seams/stitch.h"

namespace tufa {
namespace {

std::string nameOf(const Coord& index) {
  return "chunk (" + std::to_string(index[0]) + ", " + std::to_string(index[1]) + ", " +
         std::to_string(index[2]) + ")";
}

Coord beyond(Coord index, int face) {
  index[face / 2] += face % 2 == 0 ? -1 : 1;
  return index;
}

const ChunkLevel& levelOf(const Chunk& chunk, std::size_t level) {
  if (level < chunk.levels.size()) return chunk.levels[level];
  throw Error(ErrorCode::InvalidArgument, nameOf(chunk.index) + " has " +
                                              std::to_string(chunk.levels.size()) +
                                              " levels and no level " + std::to_string(level));
}

/// Several meshes while they are welded to one.
class Weld {
 public:
  explicit Weld(Mesh& mesh) : mesh_(mesh), welder_(mesh.positions) {}

  VertexIndex add(const Position& position, const Normal& normal) {
    const VertexIndex vertex = welder_.indexOf(position);
    if (vertex == mesh_.normals.size()) mesh_.normals.push_back(normal);
    return vertex;
  }

  /// Adds a triangle, unless two of its corners became one.
  void addTriangle(VertexIndex a, VertexIndex b, VertexIndex c) {
    if (a != b && b != c && c != a) mesh_.triangles.emplace_back(a, b, c);
  }

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }

 private:
  Mesh& mesh_;
  base::VertexWelder welder_;
};

/// The vertices of one LOD of a chunk, as indices in the common mesh, to which they are added when
/// they are first used.
class LevelVertices {
 public:
  LevelVertices(const ChunkLevel& level, Weld& weld)
      : level_(level), weld_(weld), places_(level.positions.size(), ChunkSeam::kNone) {}

  VertexIndex operator[](VertexIndex vertex) {
    VertexIndex& place = places_[vertex];
    if (place == ChunkSeam::kNone) {
      place = weld_.add(level_.positions[vertex], level_.normals[vertex]);
    }
    return place;
  }

  void add(const std::vector<Triangle>& triangles) {
    for (const Triangle& t : triangles) {
      weld_.addTriangle((*this)[t.vertices[0]], (*this)[t.vertices[1]], (*this)[t.vertices[2]]);
    }
  }

 private:
  const ChunkLevel& level_;
  Weld& weld_;
  std::vector<VertexIndex> places_;
};

/// Whether a vertex occurs again after others.
bool comesAgain(const ChunkSeam& seam) {
  std::vector<VertexIndex> runs = seam.tiles;
  runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
  if (seam.closed && runs.size() > 1 && runs.front() == runs.back()) runs.pop_back();
  std::sort(runs.begin(), runs.end());
  return std::adjacent_find(runs.begin(), runs.end()) != runs.end();
}

/// Adds the strip between the tiles of one LOD and the polyline of another.
void addStrip(const ChunkSeam& seam, LevelVertices& tiles, const ChunkSeam& coarse,
              LevelVertices& line, Weld& weld) {
  if (seam.tiles.empty()) return;
  ChunkSeam both;
  both.closed = seam.closed;
  for (const VertexIndex tile : seam.tiles) both.tiles.push_back(tiles[tile]);
  for (const VertexIndex vertex : coarse.polyline) both.polyline.push_back(line[vertex]);
  if (seam.begin != ChunkSeam::kNone) both.begin = tiles[seam.begin];
  if (seam.end != ChunkSeam::kNone) both.end = tiles[seam.end];
  const Mesh& mesh = weld.mesh();
  for (const chunks::StripTriangle& strip :
       chunks::stitch(both, comesAgain(both), mesh.positions, mesh.normals)) {
    const auto& v = strip.triangle.vertices;
    weld.addTriangle(v[0], v[1], v[2]);
  }
}

/// Adds the strip on `face` of a chunk at LOD `lod` towards a neighbour at LOD `coarse`, from the
/// chunk's own seams: the polyline is the same for both chunks.
void addDistantStrip(const Chunk& chunk, std::size_t lod, std::size_t coarse, std::size_t face,
                     LevelVertices& tiles, Weld& weld) {
  const ChunkLevel& own = chunk.levels[lod];
  const ChunkLevel& other = levelOf(chunk, coarse);
  const auto& seams = own.seams[face];
  const auto& lines = other.seams[face];
  const auto fits = [](const ChunkSeam& a, const ChunkSeam& b) {
    return a.tiles.size() == b.polyline.size() && a.closed == b.closed;
  };
  if ((seams.empty() && !(own.regular[face].empty() && own.transition[face].empty())) ||
      !std::equal(seams.begin(), seams.end(), lines.begin(), lines.end(), fits)) {
    throw Error(ErrorCode::InvalidArgument,
                nameOf(chunk.index) + " has no seams: it cannot be drawn at level " +
                    std::to_string(lod) + " beside a chunk at level " + std::to_string(coarse));
  }
  LevelVertices line(other, weld);
  for (std::size_t i = 0; i < seams.size(); ++i) {
    addStrip(seams[i], tiles, lines[i], line, weld);
  }
}

}  // namespace

std::ptrdiff_t ChunkIndex::find(const Coord& index) const {
  const auto found = std::lower_bound(
      chunks.begin(), chunks.end(), index,
      [](const ChunkEntry& chunk, const Coord& other) { return chunk.index < other; });
  return found != chunks.end() && found->index == index ? found - chunks.begin() : -1;
}

std::ptrdiff_t ChunkIndex::neighbour(std::size_t chunk, int face) const {
  return find(beyond(chunks.at(chunk).index, face));
}

Mesh meshForMask(const Chunk& chunk, std::size_t level, unsigned mask) {
  const ChunkLevel& own = levelOf(chunk, level);
  if (mask >= 1u << kChunkFaces || (mask != 0 && level + 1 == chunk.levels.size())) {
    throw Error(ErrorCode::InvalidArgument, nameOf(chunk.index) + " has no strips for mask " +
                                                std::to_string(mask) + " at level " +
                                                std::to_string(level));
  }
  Mesh mesh;
  mesh.triangles = own.interior;
  for (std::size_t face = 0; face < kChunkFaces; ++face) {
    const auto& strip = (mask >> face & 1u) != 0 ? own.transition[face] : own.regular[face];
    mesh.triangles.insert(mesh.triangles.end(), strip.begin(), strip.end());
  }
  std::vector<VertexIndex> places(own.positions.size(), ChunkSeam::kNone);
  for (Triangle& triangle : mesh.triangles) {
    for (VertexIndex& vertex : triangle.vertices) {
      VertexIndex& place = places[vertex];
      if (place == ChunkSeam::kNone) {
        place = static_cast<VertexIndex>(mesh.positions.size());
        mesh.positions.push_back(own.positions[vertex]);
        mesh.normals.push_back(own.normals[vertex]);
      }
      vertex = place;
    }
  }
  return mesh;
}

Mesh assembleChunks(const std::vector<Chunk>& chunks, const std::vector<std::size_t>& lods) {
  if (lods.size() != chunks.size()) {
    throw Error(ErrorCode::InvalidArgument, std::to_string(lods.size()) + " levels for " +
                                                std::to_string(chunks.size()) + " chunks");
  }
  std::map<Coord, std::size_t> lodAt;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    if (!lodAt.emplace(chunks[i].index, lods[i]).second) {
      throw Error(ErrorCode::InvalidArgument, nameOf(chunks[i].index) + " is there twice");
    }
  }
  Mesh mesh;
  Weld weld(mesh);
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const ChunkLevel& level = levelOf(chunks[i], lods[i]);
    LevelVertices vertices(level, weld);
    vertices.add(level.interior);
    for (std::size_t face = 0; face < kChunkFaces; ++face) {
      const auto other = lodAt.find(beyond(chunks[i].index, static_cast<int>(face)));
      const std::size_t coarser =
          other == lodAt.end() || other->second < lods[i] ? 0 : other->second - lods[i];
      if (coarser <= 1) {
        vertices.add(coarser == 0 ? level.regular[face] : level.transition[face]);
      } else {
        addDistantStrip(chunks[i], lods[i], other->second, face, vertices, weld);
      }
    }
  }
  return mesh;
}

}  // namespace tufa
