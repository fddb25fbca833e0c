#pragma once

#include <span>

#include "reduce/overlay_path.h"
#include "reduce/reference_mesh.h"
#include "reduce/surface.h"

namespace tufa::reduce {

/// A surface as overlay_path.h sees a mesh.
struct OverlaySurface {
  const Surface& surface;
  std::span<const Index> opposite;  ///< of oppositeCorners()

  Vec3f operator()(Index t, int i) const { return surface.corner(t, static_cast<std::size_t>(i)); }
  [[nodiscard]] Index vertex(Index t, int i) const {
    return surface.triangles.vertex(t, static_cast<std::size_t>(i));
  }
  [[nodiscard]] Index across(Index t, int i) const {
    const Index c = opposite[3 * t + static_cast<Index>(i)];
    return c == kNone ? kNone : c / 3;
  }
};

/// A face of the reference. `owner`: of each of its vertices.
[[nodiscard]] inline OwnedFace ownedFace(const ReferenceMesh& reference,
                                         std::span<const Index> owner, Index face) {
  const auto& v = reference.vertices(face);
  return {reference.cornersOf(face), v, {owner[v[0]], owner[v[1]], owner[v[2]]}};
}

}  // namespace tufa::reduce
