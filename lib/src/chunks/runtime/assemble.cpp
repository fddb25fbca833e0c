#include <tufa/chunks.h>
#include <tufa/error.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "base/require_chunk.h"
#include "base/vec3.h"
#include "base/vertex_welder.h"

namespace tufa {
namespace {

Coord beyond(Coord index, int face) {
  index[face / 2] += face % 2 == 0 ? -1 : 1;
  return index;
}

const ChunkLevel& levelOf(const Chunk& chunk, std::size_t level) {
  if (level < chunk.levels.size()) return chunk.levels[level];
  throw Error(ErrorCode::InvalidArgument, base::chunkText(chunk.index) + " has " +
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
/// and as seen from it: polygons between places that both curves have. Those of more than three
/// corners get a vertex in the middle, as a diagonal may be an edge of the chunk already.
class FaceFiller {
 public:
  /// `becomes`: for each vertex of the finer curve the one of the coarser curve that stands for it.
  FaceFiller(const std::map<VertexIndex, VertexIndex>& becomes, Weld& weld)
      : becomes_(becomes), weld_(weld) {}

  void add(std::vector<VertexIndex> line, bool isClosed) {
    std::vector<Bridge> bridges;
    const auto isShared = [&](VertexIndex v) { return becomes_.at(v) == v; };
    if (isClosed) {
      const auto shared = std::find_if(line.begin(), line.end(), isShared);
      std::rotate(line.begin(), shared == line.end() ? line.begin() : shared, line.end());
      line.push_back(line.front());
    }
    const bool isLoop = line.front() == line.back();
    const std::size_t last = line.size() - 1;
    // A loop is divided in two at least.
    const bool isDivided =
        std::any_of(line.begin() + 1, line.begin() + std::ssize(line) - 1, isShared);
    const std::size_t middle = isLoop && !isDivided ? middleOf(line) : 0;
    bridges.push_back(bridgeAt(line, 0));
    for (std::size_t i = 1; i < last; ++i) {
      if (i == middle || isShared(line[i])) bridges.push_back(bridgeAt(line, i));
    }
    bridges.push_back(isLoop ? Bridge{last, bridges.front().middle} : bridgeAt(line, last));
    for (std::size_t i = 1; i < bridges.size(); ++i) fill(line, bridges[i - 1], bridges[i]);
  }

 private:
  /// From a vertex of the finer curve to the one of the coarser curve that stands for it. A vertex
  /// on the way makes sure that it is no edge of the chunk.
  struct Bridge {
    std::size_t at;      ///< place on the finer curve
    VertexIndex middle;  ///< kNone if both are one vertex
  };

  [[nodiscard]] Bridge bridgeAt(const std::vector<VertexIndex>& line, std::size_t at) {
    const VertexIndex from = line[at], to = becomes_.at(from);
    if (from == to) return {at, kNone};
    // Not half way: vertices on straight lines are often there.
    constexpr double kShare = 0.381966;
    const Vec3 a(weld_.mesh().positions[from]), b(weld_.mesh().positions[to]);
    const Vec3 normal = Vec3(weld_.mesh().normals[from]) + Vec3(weld_.mesh().normals[to]);
    return {at, weld_.add(a + (b - a) * kShare, Normal(normal.unitOrX()))};
  }

  // Half way along a loop, among the vertices that do not become what the first one does.
  [[nodiscard]] std::size_t middleOf(const std::vector<VertexIndex>& line) const {
    std::vector<std::size_t> places;
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      if (becomes_.at(line[i]) != becomes_.at(line[0])) places.push_back(i);
    }
    return places.empty() ? 0 : places[places.size() / 2];
  }

  // What lies between two bridges: along the coarser curve, and back along the finer one.
  void fill(const std::vector<VertexIndex>& line, const Bridge& from, const Bridge& to) {
    std::vector<VertexIndex> p;
    const auto add = [&](VertexIndex v) {
      if (v != kNone && (p.empty() || p.back() != v)) p.push_back(v);
    };
    for (std::size_t i = from.at; i <= to.at; ++i) add(becomes_.at(line[i]));
    add(to.middle);
    for (std::size_t i = to.at + 1; i-- > from.at;) add(line[i]);
    add(from.middle);
    if (p.size() > 1 && p.front() == p.back()) p.pop_back();
    if (p.size() < 3) return;
    if (p.size() == 3) return weld_.addTriangle(p[0], p[1], p[2]);
    Vec3 middle(0.0), normal(0.0);
    for (const VertexIndex v : p) {
      middle += Vec3(weld_.mesh().positions[v]);
      normal += Vec3(weld_.mesh().normals[v]);
    }
    const VertexIndex centre =
        weld_.add(middle / static_cast<double>(p.size()), Normal(normal.unitOrX()));
    for (std::size_t i = 0; i < p.size(); ++i) {
      weld_.addTriangle(p[i], p[(i + 1) % p.size()], centre);
    }
  }

  const std::map<VertexIndex, VertexIndex>& becomes_;
  Weld& weld_;
};

/// What the vertices of a chunk's curves on a face at LOD `lod` become at LOD `coarse`.
std::map<VertexIndex, VertexIndex> verticesAt(const Chunk& chunk, std::size_t lod,
                                              std::size_t coarse, std::size_t face, Weld& weld) {
  using Place = std::array<double, 3>;
  const auto placeOf = [](const Position& p) { return Place{p.x, p.y, p.z}; };
  // Level by level backwards: for each place its vertex at LOD `coarse`.
  std::map<Place, VertexIndex> at;
  std::map<VertexIndex, VertexIndex> becomes;
  for (std::size_t i = coarse + 1; i-- > lod;) {
    std::map<Place, VertexIndex> here;
    LevelVertices vertices(chunk.levels[i], weld);
    for (const ChunkSeam& seam : chunk.levels[i].seams[face]) {
      for (std::size_t n = 0; n < seam.vertices.size(); ++n) {
        const VertexIndex v = seam.vertices[n];
        if (i < coarse && (n >= seam.next.size() || !at.contains(placeOf(seam.next[n])))) {
          throw Error(ErrorCode::InvalidArgument,
                      base::chunkText(chunk.index) + " has seams at level " + std::to_string(i) +
                          " that do not lead to those of the next level");
        }
        const VertexIndex last = i == coarse ? vertices[v] : at.at(placeOf(seam.next[n]));
        here.emplace(placeOf(chunk.levels[i].positions[v]), last);
        if (i == lod) becomes.emplace(vertices[v], last);
      }
    }
    at = std::move(here);
  }
  return becomes;
}

/// Whether a chunk's curves on a face differ at two LODs. From one LOD to the next they do where
/// there are strips.
bool curvesDiffer(const Chunk& chunk, std::size_t lod, std::size_t coarse, std::size_t face) {
  const auto first = chunk.levels.begin() + static_cast<std::ptrdiff_t>(lod);
  const auto last = chunk.levels.begin() + static_cast<std::ptrdiff_t>(coarse);
  return std::any_of(first, last, [&](const ChunkLevel& level) {
    return !level.regular[face].empty() || !level.transition[face].empty();
  });
}

/// Adds the strip on `face` of a chunk at LOD `lod` towards a neighbour at LOD `coarse`: that to
/// the next LOD, and what lies in the face between the curves of that and of the neighbour.
void addDistantStrip(const Chunk& chunk, std::size_t lod, std::size_t coarse, std::size_t face,
                     LevelVertices& own, Weld& weld) {
  const ChunkLevel& next = levelOf(chunk, lod + 1);
  const ChunkLevel& other = levelOf(chunk, coarse);
  own.add(chunk.levels[lod].transition[face]);
  if (!curvesDiffer(chunk, lod + 1, coarse, face)) return;
  if (next.seams[face].empty() || next.seams[face].size() != other.seams[face].size()) {
    throw Error(ErrorCode::InvalidArgument,
                base::chunkText(chunk.index) + " has no seams: it cannot be drawn at level " +
                    std::to_string(lod) + " beside a chunk at level " + std::to_string(coarse));
  }
  const std::map<VertexIndex, VertexIndex> becomes = verticesAt(chunk, lod + 1, coarse, face, weld);
  FaceFiller filler(becomes, weld);
  LevelVertices vertices(next, weld);
  for (const ChunkSeam& seam : next.seams[face]) {
    std::vector<VertexIndex> line;
    for (const VertexIndex v : seam.vertices) line.push_back(vertices[v]);
    filler.add(std::move(line), seam.closed);
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
  if (chunk >= chunks.size() || face < 0 || face >= kChunkFaces) {
    throw Error(ErrorCode::InvalidArgument,
                "there is no face " + std::to_string(face) + " of chunk " + std::to_string(chunk) +
                    ", of " + std::to_string(chunks.size()) + " with six faces each");
  }
  return find(beyond(chunks[chunk].index, face));
}

Mesh meshForMask(const Chunk& chunk, std::size_t level, unsigned mask) {
  const ChunkLevel& own = levelOf(chunk, level);
  base::requireSound(chunk, level);
  if (mask >= 1u << kChunkFaces || (mask != 0 && level + 1 == chunk.levels.size())) {
    throw Error(ErrorCode::InvalidArgument, base::chunkText(chunk.index) +
                                                " has no strips for mask " + std::to_string(mask) +
                                                " at level " + std::to_string(level));
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
      throw Error(ErrorCode::InvalidArgument, base::chunkText(chunks[i].index) + " is there twice");
    }
    for (std::size_t level = 0; level < chunks[i].levels.size(); ++level) {
      base::requireSound(chunks[i], level);
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
