#pragma once

#include <tufa/mesh.h>
#include <functional>
#include <vector>

#include "base/job.h"
#include "intersect/surface.h"

namespace tufa::refine {

/// What mending asks of the one who made the mesh. Both are called with sorted, distinct indices,
/// for the few elements that matter only. Without `crossings`, no quad becomes a fan.
struct Source {
  /// Where each vertex may always go: the mean of the crossings that it stands for.
  std::function<std::vector<Position>(const std::vector<VertexIndex>&)> massPoints;
  /// A point of the surface in the middle of each quad: where it crosses the quad's lattice edge.
  std::function<std::vector<Position>(const std::vector<intersect::PolygonIndex>&)> crossings;
  /// Vertices that must stay where they are; empty: none. Quads of such vertices alone keep their
  /// diagonals.
  std::function<bool(VertexIndex)> isFixed;
  double voxelSize = 1;          ///< world length of a voxel
  bool singlePrecision = false;  ///< positions are, and must stay, representable as floats
  /// Go down to mass points and fans even where that helps no pair at once. Else such pairs are
  /// left over, for their cells to be split.
  bool lastResort = true;
};

/// What was done.
struct RepairReport {
  std::size_t pairsFound = 0;  ///< pairs of polygons that met
  std::size_t movedVertices = 0;
  std::size_t flippedDiagonals = 0;              ///< split along their other diagonal
  std::size_t fannedQuads = 0;                   ///< replaced by four triangles around a new vertex
  std::vector<intersect::PolygonIndex> changed;  ///< polygons that are not as they were, sorted
  std::vector<intersect::PolygonPair> left;      ///< pairs that still meet
};

/// Takes the self-intersections out of a closed mesh by small local changes: another diagonal, a
/// vertex moved a little along the surface, a fan around the crossing, vertices drawn towards their
/// mass points, whichever does the least harm. Then nothing else changes: a polygon keeps its
/// vertices, unless a fan takes its place.
///
/// `suspects`, sorted, must hold a polygon of every pair there is. The indices in the report are
/// those of the given mesh, with fan triangles behind its own; they hold only if no quad was
/// fanned. The result does not depend on the number of threads.
RepairReport repairIntersections(Mesh& mesh, const std::vector<intersect::PolygonIndex>& candidates,
                                 const Source& source, base::Job& job);

}  // namespace tufa::refine
