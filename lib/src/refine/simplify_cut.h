#pragma once

#include <functional>

#include "base/vec3.h"
#include "octree/cluster_forest.h"
#include "refine/collapse/rim.h"
#include "refine/measured.h"

namespace tufa::refine {

/// How far edges are collapsed, and what must stay.
struct Goal {
  /// If not 0: collapse down to this number of triangles, whatever tolerance results.
  std::size_t triangles = 0;
  /// If not 0: if a collapse leaves this many triangles or more, the search ends with that mesh,
  /// neither repaired nor measured.
  std::size_t giveUp = 0;
  /// Vertices that stay as they are, with all polygons between them. If there are any, vertices
  /// that the mesh lists as altered remain so, faults that were there before do not count, and some
  /// faults may be left.
  std::vector<VertexIndex> fixed = {};
  /// See Bounds.
  Rim rim = {};
  std::function<bool(VertexIndex vertex, const Vec3& point)> mayLie = nullptr;
};

/// Collapses edges of a mesh as far as the rule's tolerance and the topology allow, see collapse().
/// `mesh` may be taken from a cut or be a result itself. The result is no worse than it where that
/// keeps the rule.
///
/// collapse() bounds distances at samples only, so the result is repaired and measured, and where
/// it is at fault the same collapses are repeated in the same order under stricter bounds: uniform
/// points that are too far become samples; vertices of polygons that protrude or intersect get a
/// smaller error budget; once that does not help, the last collapses behind them are rolled back,
/// twice as many at each failure, with more and more neighbours. What was not at fault is repeated
/// without tests and stays as it is. It ends because rolling back leads to `mesh`, which keeps the
/// rule.
///
/// With a number of triangles it stops there, and the rule's tolerance is what it begins with; it
/// grows as far as it must, in `rule` too. There may then be points that are farther off.
[[nodiscard]] Measured simplifyCut(const uniform::SurfaceView& base, const Measured& mesh,
                                   octree::CutRule& rule, const Goal& goal, const Repair* repair,
                                   distance::Certifier& certifier, base::Job& job);

}  // namespace tufa::refine
