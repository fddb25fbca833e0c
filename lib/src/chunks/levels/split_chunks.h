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

/// The two meshes of one LOD of a region: with its own boundary polylines, and with those of the
/// next LOD, if any.
struct LevelMeshes {
  SeamedCut regular;
  SeamedCut transition;
  std::vector<float> regularErrors;                     ///< at each vertex, voxels
  std::vector<float> transitionErrors;                  ///< at each vertex, voxels
  std::vector<intersect::PolygonPair> pairs;            ///< of the regular mesh that intersect
  std::vector<intersect::PolygonPair> transitionPairs;  ///< of the transition mesh that intersect
  std::vector<intersect::PolygonPair> mixedPairs;       ///< see findMixedPairs()
};

/// A chunk, and for each of its LODs the number of intersecting pairs left.
struct MadeChunk {
  Chunk chunk;
  std::vector<std::size_t> pairsLeft;
};

/// Divides the meshes of a region's LODs among its chunks.
class ChunkSplitter {
 public:
  /// `vertexCells` has the cell of each uniform vertex, `seamPositions` the seams' vertices in the
  /// world. References must outlive this object.
  ChunkSplitter(const std::vector<Coord>& vertexCells, const Seams& seams,
                const std::vector<Position>& seamPositions, const ChunkCells& chunks,
                const grid::Affine& affine, bool singlePrecision);

  /// Adds an LOD, finest first. `next` has the boundary polylines of the next LOD, null for the
  /// last.
  void addLevel(const LevelMeshes& meshes, const SeamPolylines& lines, const SeamPolylines* next);
  /// The chunks that the surface passes, in the order of their indices.
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
  std::vector<std::int32_t> chunkOf_;  // of each uniform vertex
  std::vector<MadeChunk> made_;        // by chunk number
  // The index of each cluster and each vertex on a seam in the chunk at hand.
  std::vector<VertexIndex> clusterNumbers_, seamNumbers_;
  std::vector<VertexIndex> numberedClusters_, numberedSeams_;
};

}  // namespace tufa::chunks
