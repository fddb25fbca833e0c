#pragma once

#include <tufa/chunks.h>
#include <cstdint>
#include <vector>

#include "chunks/levels/seamed_cut.h"
#include "chunks/seams/chunk_cells.h"
#include "chunks/seams/polyline.h"
#include "chunks/seams/seams.h"
#include "grid/affine.h"
#include "intersect/surface.h"

namespace tufa::chunks {

/// One level of a region: with the seams of its own, and with those of the next level, if any.
struct LevelMeshes {
  SeamedCut regular;
  SeamedCut transition;
  std::vector<float> regularErrors;                     ///< at each vertex, voxels
  std::vector<float> transitionErrors;                  ///< at each vertex, voxels
  std::vector<intersect::PolygonPair> pairs;            ///< of the regular mesh that meet
  std::vector<intersect::PolygonPair> transitionPairs;  ///< of the transition mesh that meet
  std::vector<intersect::PolygonPair> mixedPairs;       ///< see findMixedPairs()
};

/// A chunk, and for each of its levels the number of pairs of its polygons that meet.
struct MadeChunk {
  Chunk chunk;
  std::vector<std::size_t> pairsLeft;
};

/// Hands the meshes of a region's levels out to its chunks.
class ChunkSplitter {
 public:
  /// The cell of each base vertex, the seams and where they are in the world; and what must outlive
  /// this object.
  ChunkSplitter(const std::vector<Coord>& vertexCells, const Seams& seams,
                const std::vector<Position>& seamPositions, const ChunkCells& chunks,
                const grid::Affine& affine, bool singlePrecision);

  /// Levels come finest first. `next` are the lines of the next level, null for the last.
  void addLevel(const LevelMeshes& meshes, const SeamPolylines& lines, const SeamPolylines* next);
  /// Chunks that the surface passes, by their indices.
  [[nodiscard]] std::vector<MadeChunk> takeChunks();

 private:
  // A polygon of a chunk, as two triangles or one.
  struct Piece {
    std::uint32_t polygon;  // quads first
    int face;               // the strip it is in, or kInterior
  };
  static constexpr int kInterior = -1;

  void sortPieces(const SeamedCut& mesh, std::vector<std::vector<Piece>>& pieces) const;
  void fillLevel(const LevelMeshes& meshes, std::int32_t chunk, const std::vector<Piece>& regular,
                 const std::vector<Piece>& transition, const SeamPolylines& lines,
                 ChunkLevel& level);
  void countPairs(const LevelMeshes& meshes, const std::vector<std::vector<Piece>>& regular,
                  const std::vector<std::vector<Piece>>& transition);
  void addPieces(const SeamedCut& mesh, const std::vector<Piece>& pieces, ChunkLevel& level,
                 bool transition);
  void addSeams(const SeamedCut& mesh, std::int32_t chunk, const SeamPolylines& lines,
                ChunkLevel& level);
  [[nodiscard]] VertexIndex numberOf(const SeamedCut& mesh, VertexIndex vertex, ChunkLevel& level);
  [[nodiscard]] VertexIndex numberOfSeam(SeamIndex seam, ChunkLevel& level);

  const Seams& seams_;
  const std::vector<Position>& seamPositions_;
  const ChunkCells& chunks_;
  const grid::Affine& affine_;
  bool singlePrecision_;
  std::vector<std::int32_t> chunkOf_;  // of each base vertex
  std::vector<MadeChunk> made_;        // by chunk number
  // The number that each cluster and each vertex on a seam has in the chunk at work.
  std::vector<VertexIndex> clusterNumbers_, seamNumbers_;
  std::vector<VertexIndex> numberedClusters_, numberedSeams_;
};

}  // namespace tufa::chunks
