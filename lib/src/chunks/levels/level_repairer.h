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

/// What repair may move: vertices of larger cells, or all but those on seams, which other chunks
/// have too.
enum class Movable : std::uint8_t { Clusters, All };

/// Repairs the self-intersections of a region's LODs.
class LevelRepairer {
 public:
  /// What all LODs share; must outlive this object.
  struct Region {
    const std::vector<Coord>& cells;                      ///< of the uniform vertices
    const std::vector<std::uint32_t>& uniformCandidates;  ///< see intersect::findCandidates()
    const Seams& seams;
    const std::vector<Position>& seamPositions;  ///< of the vertices on seams, in the world
    const ChunkCells& chunks;
    const grid::Affine& affine;
    bool singlePrecision;  ///< positions are rounded to floats
  };

  /// The polygons of an LOD's regular mesh that intersected no others after its last repair, by
  /// digits of their corners; sorted. Pairs of such polygons are not searched again.
  using Clean = std::vector<std::array<std::uint64_t, 2>>;

  LevelRepairer(const Region& region, base::Job& job) : region_(region), job_(job) {}

  /// Moves vertices and flips diagonals until no polygons intersect, in positions as they will be
  /// written, as far as possible; tells which pairs are left. The two meshes of the LOD, which
  /// share all but polylines and strips, are repaired alternately, or the regular one `alone`.
  /// Pairs of a strip of each are found but not repaired.
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
