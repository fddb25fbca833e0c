#pragma once

#include <functional>

#include "base/vec3.h"
#include "octree/cluster_forest.h"
#include "refine/collapse/rim.h"
#include "refine/measured.h"

namespace tufa::refine {

/// How far edges are collapsed.
struct Goal {
  /// If not 0: down to so many triangles, and the tolerance is what comes of it.
  std::size_t triangles = 0;
  /// If not 0: where a collapse leaves so many triangles or more, that is the result, neither
  /// mended nor measured.
  std::size_t giveUp = 0;
  /// Vertices that stay as they are, with all polygons between them. If there are any, those that
  /// the mesh says are altered stay so, what was faulty before is no fault, and some faults may be
  /// left.
  std::vector<VertexIndex> fixed = {};
  /// See Bounds.
  Rim rim = {};
  std::function<bool(VertexIndex vertex, const Vec3& point)> mayLie = nullptr;
};

/// Collapses edges of a mesh as far as the rule's tolerance and the topology allow:
/// collapse(), with the planes of the base vertices that each vertex stands for, then
/// mended, measured, and begun again with less freedom around the vertices that were faulty, until
/// none is. `mesh` may be taken from a cut or be a result itself. The result is no worse than it
/// where that keeps the rule.
///
/// With a number of triangles, it stops there, and the rule's tolerance is what it begins with: it
/// grows as far as it must, in the rule, too. There may then be points that are farther off.
[[nodiscard]] Measured simplifyCut(const uniform::SurfaceView& base, const Measured& mesh,
                                   octree::CutRule& rule, const Goal& goal, const Repair* repair,
                                   distance::Certifier& certifier, base::Job& job);

}  // namespace tufa::refine
