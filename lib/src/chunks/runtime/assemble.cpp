#include <tufa/chunks.h>
#include <tufa/error.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "base/vec3.h"
#include "base/vertex_welder.h"

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

constexpr VertexIndex kNone = std::numeric_limits<VertexIndex>::max();

/// Several meshes while they are welded to one.
class Weld {
 public:
  explicit Weld(Mesh& mesh) : mesh_(mesh), welder_(mesh.positions) {}

  VertexIndex add(const Position& position, const Normal& normal) {
    const VertexIndex vertex = welder_.indexOf(position);
    if (vertex == mesh_.normals.size()) {
      mesh_.normals.push_back(normal);
    } else if (!(mesh_.normals[vertex] == normal)) {
      sums_.try_emplace(vertex, mesh_.normals[vertex]).first->second += Vec3(normal);
    }
    return vertex;
  }

  /// Gives vertices of several normals their mean, at the end.
  void joinNormals() {
    for (const auto& [vertex, sum] : sums_) mesh_.normals[vertex] = Normal(sum.unitOrX());
  }

  /// Adds a triangle, unless two of its corners became one.
  void addTriangle(VertexIndex a, VertexIndex b, VertexIndex c) {
    if (a != b && b != c && c != a) mesh_.triangles.emplace_back(a, b, c);
  }

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }

 private:
  Mesh& mesh_;
  base::VertexWelder welder_;
  std::map<VertexIndex, Vec3> sums_;  ///< of normals, where there are several
};

/// The vertices of one LOD of a chunk, as indices in the common mesh, to which they are added when
/// they are first used.
class LevelVertices {
 public:
  LevelVertices(const ChunkLevel& level, Weld& weld)
      : level_(level), weld_(weld), places_(level.positions.size(), kNone) {}

  VertexIndex operator[](VertexIndex vertex) {
    VertexIndex& place = places_[vertex];
    if (place == kNone) {
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

/// The surface in a face between the curve of one LOD and that of a coarser one, both of one chunk
/// and as seen from it: a polygon for each edge of the coarser one. Those of more than three
/// corners get a vertex in the middle, as a diagonal may be an edge of the chunk already.
class FaceFiller {
 public:
  FaceFiller(LevelVertices& fine, LevelVertices& coarse, Weld& weld)
      : fine_(fine), coarse_(coarse), weld_(weld) {}

  void add(const std::vector<ChunkSeam>& fine, const std::vector<ChunkSeam>& coarse) {
    std::set<VertexIndex> kept;
    for (const ChunkSeam& seam : coarse) {
      for (const VertexIndex v : seam.vertices) kept.insert(coarse_[v]);
    }
    for (const ChunkSeam& seam : fine) {
      std::vector<VertexIndex> line;
      for (const VertexIndex v : seam.vertices) line.push_back(fine_[v]);
      const auto isKept = [&](VertexIndex v) { return kept.contains(v); };
      if (seam.closed) {
        std::rotate(line.begin(), std::find_if(line.begin(), line.end(), isKept), line.end());
        line.push_back(line.front());
      }
      std::vector<VertexIndex> polygon;
      for (const VertexIndex v : line) {
        polygon.push_back(v);
        if (polygon.size() == 1 || !isKept(v)) continue;
        fill(polygon);
        polygon.assign(1, v);
      }
    }
  }

 private:
  // From the last corner back along the finer curve.
  void fill(const std::vector<VertexIndex>& p) {
    if (p.size() < 3) return;
    if (p.size() == 3) return weld_.addTriangle(p[0], p[2], p[1]);
    Vec3 middle(0.0), normal(0.0);
    for (const VertexIndex v : p) {
      middle += Vec3(weld_.mesh().positions[v]);
      normal += Vec3(weld_.mesh().normals[v]);
    }
    const VertexIndex centre =
        weld_.add(middle / static_cast<double>(p.size()), Normal(normal.unitOrX()));
    weld_.addTriangle(p.front(), p.back(), centre);
    for (std::size_t i = p.size() - 1; i > 0; --i) weld_.addTriangle(p[i], p[i - 1], centre);
  }

  LevelVertices& fine_;
  LevelVertices& coarse_;
  Weld& weld_;
};

/// Adds the strip on `face` of a chunk at LOD `lod` towards a neighbour at LOD `coarse`: that to
/// the next LOD, and what lies in the face between the curves of that and of the neighbour.
void addDistantStrip(const Chunk& chunk, std::size_t lod, std::size_t coarse, std::size_t face,
                     LevelVertices& own, Weld& weld) {
  const ChunkLevel& next = levelOf(chunk, lod + 1);
  const ChunkLevel& other = levelOf(chunk, coarse);
  own.add(chunk.levels[lod].transition[face]);
  const bool hasStrips = !next.regular[face].empty() || !next.transition[face].empty();
  if (next.seams[face].empty() ? hasStrips : next.seams[face].size() != other.seams[face].size()) {
    throw Error(ErrorCode::InvalidArgument,
                nameOf(chunk.index) + " has no seams: it cannot be drawn at level " +
                    std::to_string(lod) + " beside a chunk at level " + std::to_string(coarse));
  }
  LevelVertices fine(next, weld), line(other, weld);
  FaceFiller(fine, line, weld).add(next.seams[face], other.seams[face]);
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
  for (const Attribute& attribute : own.attributes) {
    mesh.attributes.push_back({attribute.name, attribute.width, attribute.role});
  }
  std::vector<VertexIndex> places(own.positions.size(), kNone);
  for (Triangle& triangle : mesh.triangles) {
    for (VertexIndex& vertex : triangle.vertices) {
      VertexIndex& place = places[vertex];
      if (place == kNone) {
        place = static_cast<VertexIndex>(mesh.positions.size());
        mesh.positions.push_back(own.positions[vertex]);
        mesh.normals.push_back(own.normals[vertex]);
        for (std::size_t i = 0; i < own.attributes.size(); ++i) {
          const std::size_t width = static_cast<std::size_t>(own.attributes[i].width);
          const auto from =
              own.attributes[i].values.begin() + static_cast<std::ptrdiff_t>(width * vertex);
          mesh.attributes[i].values.insert(mesh.attributes[i].values.end(), from,
                                           from + static_cast<std::ptrdiff_t>(width));
        }
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
  weld.joinNormals();
  return mesh;
}

}  // namespace tufa
