#pragma once

#include <tufa/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/vec3f.h"
#include "reduce/corners.h"
#include "reduce/overlay_path.h"
#include "reduce/triangles.h"

namespace tufa::refine {

/// Triangles of a cut, as reduce/overlay_path.h sees a mesh.
struct CutTriangles {
  std::vector<Triangle> corners;
  /// Twice the uniform quad that its polygon comes from plus its number in that polygon.
  std::vector<std::uint32_t> ids;
  std::vector<base::Vec3f> positions;  ///< of the vertices, in voxels
  std::vector<reduce::Index> opposite;

  base::Vec3f operator()(reduce::Index t, int i) const { return positions[vertex(t, i)]; }
  [[nodiscard]] VertexIndex vertex(reduce::Index t, int i) const {
    return corners[t].vertices[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] reduce::Index across(reduce::Index t, int i) const {
    const reduce::Index c = opposite[3 * t + static_cast<reduce::Index>(i)];
    return c == reduce::kNone ? reduce::kNone : c / 3;
  }
  /// The ways that CutDistance promises.
  [[nodiscard]] bool mayPass(reduce::Index t, reduce::Index from, reduce::Index to) const {
    return touch(t, from) || touch(t, to);
  }
  [[nodiscard]] bool touch(reduce::Index a, reduce::Index b) const {
    const auto& v = corners[b].vertices;
    return std::any_of(v.begin(), v.end(),
                       [&](VertexIndex i) { return reduce::hasVertex(*this, a, i); });
  }
  /// The triangle beside t around one of its vertices, in one of two directions, 1 or 2; kNone if v
  /// is not one of them.
  [[nodiscard]] reduce::Index turn(reduce::Index t, VertexIndex v, int direction) const {
    for (int i = 0; i < 3; ++i) {
      if (vertex(t, i) == v) return across(t, (i + direction) % 3);
    }
    return reduce::kNone;
  }
  /// Adds to a way, which ends at a triangle with vertex v, the triangles around v up to one that
  /// `isEnd`, the shorter way round. False if there is none, or the way gets too long.
  template <class IsEnd>
  bool walkAround(VertexIndex v, const IsEnd& isEnd, reduce::OverlayPath& way) const {
    const reduce::Index first = way.triangles[static_cast<std::size_t>(way.count - 1)];
    if (isEnd(first)) return true;
    std::array<reduce::Index, reduce::OverlayPath::kMost> best{}, steps{};
    int bestCount = reduce::OverlayPath::kMost + 1 - way.count;
    for (const int direction : {1, 2}) {
      int count = 0;
      for (reduce::Index t = turn(first, v, direction);
           t != reduce::kNone && t != first && count + 1 < bestCount; t = turn(t, v, direction)) {
        steps[static_cast<std::size_t>(count++)] = t;
        if (!isEnd(t)) continue;
        best = steps, bestCount = count;
        break;
      }
    }
    if (bestCount + way.count > reduce::OverlayPath::kMost) return false;
    std::copy_n(best.begin(), bestCount, way.triangles.begin() + way.count);
    way.count += bestCount;
    return true;
  }
  [[nodiscard]] float distance(reduce::Index t, base::Vec3f p) const {
    return std::sqrt(
        reduce::squaredDistanceToTriangle(p, (*this)(t, 0), (*this)(t, 1), (*this)(t, 2)));
  }
};

}  // namespace tufa::refine
