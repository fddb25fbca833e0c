#include "chunks/levels/split_chunks.h"

#include <algorithm>

#include "base/single_precision.h"

namespace tufa::chunks {
namespace {

constexpr VertexIndex kNoNumber = ChunkSeam::kNone;

// The vertices of a polygon, quads first.
std::array<VertexIndex, 4> cornersOf(const Mesh& mesh, std::uint32_t polygon, int& count) {
  if (polygon < mesh.quads.size()) {
    count = 4;
    return mesh.quads[polygon].vertices;
  }
  count = 3;
  const auto& v = mesh.triangles[polygon - mesh.quads.size()].vertices;
  return {v[0], v[1], v[2], v[2]};
}

}  // namespace

ChunkSplitter::ChunkSplitter(const std::vector<Coord>& vertexCells, const Seams& seams,
                             const std::vector<Position>& seamPositions, const ChunkCells& chunks,
                             const grid::Affine& affine, bool singlePrecision)
    : seams_(seams),
      seamPositions_(seamPositions),
      chunks_(chunks),
      affine_(affine),
      singlePrecision_(singlePrecision),
      made_(static_cast<std::size_t>(chunks.count())),
      seamNumbers_(seams.vertices.size(), kNoNumber) {
  chunkOf_.reserve(vertexCells.size());
  for (const Coord& cell : vertexCells) {
    chunkOf_.push_back(chunks.numberOf(chunks.chunkOf(cell)));
  }
  for (std::int32_t i = 0; i < chunks.count(); ++i) made_[i].chunk.index = chunks.chunkAt(i);
}

void ChunkSplitter::addLevel(const LevelMeshes& meshes, const SeamPolylines& lines,
                             const SeamPolylines* next) {
  std::vector<std::vector<Piece>> regular(made_.size()), transition(made_.size());
  sortPieces(meshes.regular, regular);
  if (next != nullptr) sortPieces(meshes.transition, transition);
  clusterNumbers_.assign(meshes.regular.clusterCount, kNoNumber);
  for (std::int32_t chunk = 0; chunk < chunks_.count(); ++chunk) {
    MadeChunk& made = made_[chunk];
    fillLevel(meshes, chunk, regular[chunk], transition[chunk], lines,
              made.chunk.levels.emplace_back());
    made.pairsLeft.push_back(0);
  }
  countPairs(meshes, regular, transition);
}

// Counts the pairs of each chunk; those that both meshes have count once.
void ChunkSplitter::countPairs(const LevelMeshes& meshes,
                               const std::vector<std::vector<Piece>>& regular,
                               const std::vector<std::vector<Piece>>& transition) {
  const auto chunksOf = [&](const SeamedCut& mesh, const std::vector<std::vector<Piece>>& pieces) {
    const Mesh& own = mesh.made.mesh;
    std::vector<std::int32_t> chunks(own.quads.size() + own.triangles.size(), ChunkCells::kNotOwn);
    for (std::int32_t chunk = 0; chunk < chunks_.count(); ++chunk) {
      for (const Piece& piece : pieces[chunk]) chunks[piece.polygon] = chunk;
    }
    return chunks;
  };
  const auto count = [&](std::int32_t chunk) {
    if (chunk != ChunkCells::kNotOwn) ++made_[chunk].pairsLeft.back();
  };
  const std::vector<std::int32_t> ofRegular = chunksOf(meshes.regular, regular);
  for (const auto& [a, b] : meshes.pairs) count(std::max(ofRegular[a], ofRegular[b]));
  for (const auto& [a, b] : meshes.mixedPairs) count(ofRegular[a]);
  const std::vector<std::int32_t> ofTransition = chunksOf(meshes.transition, transition);
  const std::size_t firstStrip = meshes.transition.firstStripPolygon();
  for (const auto& [a, b] : meshes.transitionPairs) {
    if (b >= firstStrip) count(std::max(ofTransition[a], ofTransition[b]));
  }
}

std::vector<MadeChunk> ChunkSplitter::takeChunks() {
  std::vector<MadeChunk> chunks;
  for (MadeChunk& made : made_) {
    if (!made.chunk.levels.empty() && !made.chunk.levels[0].positions.empty()) {
      chunks.push_back(std::move(made));
    }
  }
  return chunks;
}

// Assigns polygons to chunks: each has a vertex of a cluster, which lies in its chunk.
void ChunkSplitter::sortPieces(const SeamedCut& mesh,
                               std::vector<std::vector<Piece>>& pieces) const {
  std::vector<std::int32_t> chunkOfCluster(mesh.clusterCount, ChunkCells::kNotOwn);
  for (std::size_t i = 0; i < chunkOf_.size(); ++i) {
    chunkOfCluster[mesh.cut.vertexOf[i]] = chunkOf_[i];
  }
  const Mesh& own = mesh.made.mesh;
  const std::size_t count = own.quads.size() + own.triangles.size();
  const std::size_t firstStrip = mesh.firstStripPolygon();
  for (std::uint32_t polygon = 0; polygon < count; ++polygon) {
    int corners = 0;
    std::int32_t chunk = ChunkCells::kNotOwn;
    for (const VertexIndex vertex : cornersOf(own, polygon, corners)) {
      if (!mesh.isOnSeam(vertex)) chunk = chunkOfCluster[vertex];
    }
    if (chunk == ChunkCells::kNotOwn) continue;
    int face = kInterior;
    if (polygon >= firstStrip) {
      const StripPlace& place = mesh.strips[polygon - firstStrip];
      face = 2 * seams_.curves[place.curve].axis + (place.above ? 0 : 1);
    }
    pieces[chunk].push_back({polygon, face});
  }
}

// Vertices are numbered in the order in which polygons first use them: the interior and regular
// strips, then seams, then transition strips. Their indices are reset one by one, as a chunk uses
// few of a region's.
void ChunkSplitter::fillLevel(const LevelMeshes& meshes, std::int32_t chunk,
                              const std::vector<Piece>& regular,
                              const std::vector<Piece>& transition, const SeamPolylines& lines,
                              ChunkLevel& level) {
  addPieces(meshes.regular, regular, level, false);
  addSeams(meshes.regular, chunk, lines, level);
  addPieces(meshes.transition, transition, level, true);
  const auto worst = [](const SeamedCut& mesh, const std::vector<Piece>& pieces,
                        const std::vector<float>& errors) {
    float most = 0;
    for (const Piece& piece : pieces) {
      int count = 0;
      for (const VertexIndex vertex : cornersOf(mesh.made.mesh, piece.polygon, count)) {
        most = std::max(most, errors[vertex]);
      }
    }
    return static_cast<double>(most);
  };
  level.maxErrorVoxels = worst(meshes.regular, regular, meshes.regularErrors);
  level.transitionErrorVoxels = worst(meshes.transition, transition, meshes.transitionErrors);
  for (const VertexIndex cluster : numberedClusters_) clusterNumbers_[cluster] = kNoNumber;
  for (const SeamIndex seam : numberedSeams_) seamNumbers_[seam] = kNoNumber;
  numberedClusters_.clear();
  numberedSeams_.clear();
}

void ChunkSplitter::addPieces(const SeamedCut& mesh, const std::vector<Piece>& pieces,
                              ChunkLevel& level, bool transition) {
  for (const Piece& piece : pieces) {
    if (transition && piece.face == kInterior) continue;
    std::vector<Triangle>& triangles = piece.face == kInterior ? level.interior
                                       : transition            ? level.transition[piece.face]
                                                               : level.regular[piece.face];
    int count = 0;
    auto v = cornersOf(mesh.made.mesh, piece.polygon, count);
    for (int i = 0; i < count; ++i) v[i] = numberOf(mesh, v[i], level);
    triangles.push_back({v[0], v[1], v[2]});
    if (count == 4) triangles.push_back({v[0], v[2], v[3]});
  }
}

void ChunkSplitter::addSeams(const SeamedCut& mesh, std::int32_t chunk, const SeamPolylines& lines,
                             ChunkLevel& level) {
  for (const SeamCurve& curve : seams_.curves) {
    const bool above = chunks_.numberOf(curve.chunk) == chunk;
    Coord lower = curve.chunk;
    --lower[curve.axis];
    if (!above && chunks_.numberOf(lower) != chunk) continue;
    ChunkSeam seam;
    for (const SeamIndex arc : curve.arcs) {
      const VertexIndex base = above ? seams_.arcs[arc].above : seams_.arcs[arc].below;
      seam.tiles.push_back(numberOf(mesh, mesh.cut.vertexOf[base], level));
      seam.polyline.push_back(numberOfSeam(lines[arc], level));
    }
    if (curve.begin != kNoSeam) seam.begin = numberOfSeam(curve.begin, level);
    if (curve.end != kNoSeam) seam.end = numberOfSeam(curve.end, level);
    seam.closed = curve.closed;
    if (above) {
      std::reverse(seam.tiles.begin(), seam.tiles.end());
      std::reverse(seam.polyline.begin(), seam.polyline.end());
      std::swap(seam.begin, seam.end);
    }
    level.seams[2 * curve.axis + (above ? 0 : 1)].push_back(std::move(seam));
  }
}

VertexIndex ChunkSplitter::numberOf(const SeamedCut& mesh, VertexIndex vertex, ChunkLevel& level) {
  if (mesh.isOnSeam(vertex)) return numberOfSeam(mesh.seamAt(vertex), level);
  VertexIndex& number = clusterNumbers_[vertex];
  if (number == kNoNumber) {
    number = static_cast<VertexIndex>(level.positions.size());
    numberedClusters_.push_back(vertex);
    const Position world = affine_.toWorld(mesh.made.mesh.positions[vertex]);
    level.positions.push_back(singlePrecision_ ? base::toSingle(world) : world);
    level.normals.push_back(mesh.made.mesh.normals[vertex]);
  }
  return number;
}

VertexIndex ChunkSplitter::numberOfSeam(SeamIndex seam, ChunkLevel& level) {
  VertexIndex& number = seamNumbers_[seam];
  if (number == kNoNumber) {
    number = static_cast<VertexIndex>(level.positions.size());
    numberedSeams_.push_back(seam);
    level.positions.push_back(seamPositions_[seam]);
    level.normals.push_back(seams_.vertices[seam].normal);
  }
  return number;
}

}  // namespace tufa::chunks
