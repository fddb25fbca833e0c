#pragma once

#include <tufa/mesh.h>
#include <functional>
#include <vector>

#include "base/job.h"
#include "intersect/surface.h"

namespace tufa::refine {

/// What repair asks of the owner of a mesh. Both functions are called with sorted, distinct
/// indices, and only for the few elements that are involved. Without `crossings`, no quad becomes a
/// fan.
struct Source {
  /// The fallback position of each vertex, where it may always go: its mass point, the mean of the
  /// crossings that it stands for.
  std::function<std::vector<Position>(const std::vector<VertexIndex>&)> massPoints;
  /// A point of the surface in the middle of each quad: where it crosses the quad's lattice edge.
  std::function<std::vector<Position>(const std::vector<intersect::PolygonIndex>&)> crossings;
  /// Vertices that must stay where they are; empty: none. Quads of such vertices alone keep their
  /// diagonals.
  std::function<bool(VertexIndex)> isFixed;
  double voxelSize = 1;          ///< world length of a voxel
  std::size_t wholeSize = 0;     ///< polygons of the mesh that this is a part of; 0: it is all
  bool singlePrecision = false;  ///< positions are, and must stay, representable as floats
  /// Where no small change helps, take the last resort: mass points, then fans, even if that helps
  /// no pair at once. Otherwise such pairs are left, for their cells to be split.
  bool lastResort = true;
};

/// What a repair found and did.
struct RepairReport {
  struct Moved {
    VertexIndex vertex;
    Position from;
  };
  std::size_t pairsFound = 0;  ///< pairs of polygons that intersected
  std::size_t movedVertices = 0;
  std::size_t flippedDiagonals = 0;              ///< split along their other diagonal
  std::size_t fannedQuads = 0;                   ///< replaced by four triangles around a new vertex
  std::vector<intersect::PolygonIndex> changed;  ///< polygons that are not as they were, sorted
  std::vector<Moved> moved;                      ///< vertices that are not where they were, sorted
  std::vector<intersect::PolygonPair> left;      ///< pairs that still intersect
};

/// Removes self-intersections of a closed mesh by small local changes: another diagonal, a vertex
/// moved a little along the surface, a fan around the crossing, vertices moved to or towards their
/// fallback positions, whichever does the least harm. Nothing else changes: a polygon keeps its
/// vertices unless a fan takes its place, so connectivity and Euler characteristic stay.
///
/// `candidates`, sorted, must hold a polygon of every pair there is. The indices in the report are
/// those of the given mesh, with fan triangles behind its own; they hold only if no quad was
/// fanned. The result does not depend on the number of threads.
///
/// This is a bounded search and no proof: `left` tells what remains. Why it nearly always succeeds:
/// a change is kept only if it leaves fewer pairs, so small changes never make things worse, and no
/// input is known whose uniform mesh has pairs with all vertices at their mass points. Cost: a
/// search for pairs around the changes of each round; with few pairs, next to nothing.
RepairReport repairIntersections(Mesh& mesh, const std::vector<intersect::PolygonIndex>& candidates,
                                 const Source& source, base::Job& job);

}  // namespace tufa::refine
