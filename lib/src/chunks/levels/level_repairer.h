#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "chunks/levels/split_chunks.h"
#include "chunks/seams/chunk_cells.h"
#include "chunks/seams/seams.h"
#include "grid/affine.h"
#include "intersect/surface.h"

namespace tufa::chunks {

/// What may move so that no polygons meet: vertices that stand for larger cells, or all but those
/// on seams, which other chunks have too.
enum class Movable : std::uint8_t { Clusters, All };

/// Takes the self-intersections out of a region's levels.
class LevelRepairer {
 public:
  /// What all levels share; must outlive the mender.
  struct Region {
    const std::vector<Coord>& cells;                      ///< of the base vertices
    const std::vector<std::uint32_t>& uniformCandidates;  ///< see intersect::findSuspects()
    const Seams& seams;
    const std::vector<Position>& seamPositions;  ///< of the vertices on seams, in the world
    const ChunkCells& chunks;
    const grid::Affine& affine;
    bool singlePrecision;  ///< positions are rounded to floats
  };

  /// The polygons of a level's regular mesh that met no others when it was mended last, by digits
  /// of their corners; sorted. Where all is as it was then, nothing is searched again.
  using Clean = std::vector<std::array<std::uint64_t, 2>>;

  LevelRepairer(const Region& region, base::Job& job) : region_(region), job_(job) {}

  /// Moves vertices and turns quads until no polygons meet, as they will be written, where that can
  /// be; says which pairs are left. The two meshes of the level, which share all but their strips,
  /// are mended in turn; or the regular one `alone`. Pairs of a strip of each are found only.
  void repairIntersections(LevelMeshes& meshes, bool alone, Movable movable, Clean& clean) const;

 private:
  void repairInSequence(LevelMeshes& meshes, Movable movable, Clean& clean) const;
  void repairRegular(LevelMeshes& meshes, Movable movable, Clean& clean) const;
  [[nodiscard]] std::vector<intersect::PolygonPair> repairIntersections(
      SeamedCut& mesh, Movable movable, std::vector<intersect::PolygonIndex> candidates,
      Clean* clean) const;
  [[nodiscard]] bool isFixed(const SeamedCut& mesh, VertexIndex vertex, Movable movable) const;

  Region region_;
  base::Job& job_;
};

}  // namespace tufa::chunks
