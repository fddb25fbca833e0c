#pragma once

#include <tufa/check.h>
#include <tufa/export.h>
#include <tufa/mesh.h>
#include <cstddef>

namespace tufa {

/// Options of repair().
struct RepairOptions {
  /// Vertices nearer to each other than this, in world units, become one; 0: those at bit-equal
  /// positions.
  double mergeDistance = 0;
  /// Holes of up to that many edges are filled; 0: none. The outline of a sheet without vertices
  /// inside, such as a lone triangle, is no hole.
  int fillEdges = 0;
  /// Drop connected parts that still have a boundary once holes are filled, if others have none:
  /// dangling sheets.
  bool dropOpen = false;
  int threads = 0;         ///< of the checks before and after; 0: all
  Progress progress = {};  ///< called from the calling thread; may cancel between the steps
};

/// What repair() did.
struct RepairReport {
  std::size_t mergedVertices = 0;   ///< made one with another
  std::size_t unusedVertices = 0;   ///< dropped: of no face, or of none that is left
  std::size_t degenerateFaces = 0;  ///< dropped: an invalid or a repeated index, or no area
  std::size_t duplicateFaces = 0;   ///< dropped: the vertices of another face
  std::size_t splitVertices = 0;    ///< copies made where edges or vertices were not manifold
  std::size_t filledHoles = 0;      ///< holes that were filled
  std::size_t droppedParts = 0;     ///< parts dropped by dropOpen
  CheckReport before;               ///< of the input
  CheckReport after;                ///< of the result
  /// The result would have had more faults than the input, which was returned as it is.
  bool keptInput = false;
};

/// Repairs a soup of triangles, as meshes of other programs may be: merges vertices, drops
/// degenerate and duplicate faces, splits edges and vertices that are not manifold, orients the
/// faces, fills small holes. Closed parts that do not intersect are turned to bound a volume,
/// others as most of their area was. By CGAL's Polygon Mesh Processing, and checked by check(): the
/// result never has more faults than the input (edges and vertices that are open, not manifold or
/// misoriented; invalid, collapsed and duplicate faces). Self-intersections are left; see the
/// report. Normals are dropped, quads become triangles.
///
/// Uses CGAL (GPL): it is in Tufa::check. Throws Error: InvalidArgument for options out of their
/// range, LimitExceeded, Cancelled.
[[nodiscard]] TUFA_API Mesh repair(const Mesh& mesh, const RepairOptions& options = {},
                                   RepairReport* report = nullptr);

}  // namespace tufa
