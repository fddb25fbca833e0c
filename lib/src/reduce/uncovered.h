#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/bvh.h"
#include "base/job.h"
#include "reduce/measured.h"
#include "reduce/overlay_surface.h"
#include "reduce/reference_mesh.h"

namespace tufa::reduce {

/// Triangles of the surface that the faces of the reference may not reach all of: those of closed
/// components at which the degree of the map of certify() is not one or cannot be counted, as there
/// is no vertex around which all faces have ways; see map_degree.h. And what gaps cut off.
///
/// Faces that are halved go nowhere. What the others go to has the ways along the edges of those
/// for its border, so the degree is the same at all points of a *piece*, triangles that are
/// connected by others than the gaps. It is counted in the largest piece of a closed component; at
/// open borders it is one. Triangles of other pieces are told, and gaps with a corner in none of
/// these.
struct Uncovered {
  std::vector<Index> triangles;
  /// Those of the reference that go to these components and are within twice the expected distance
  /// of one of the triangles; all, if that leaves a triangle without.
  std::vector<Index> faces;
};

/// What certify() measures.
struct Measuring {
  const OverlaySurface& overlay;
  const CornersOfVertices& corners;
  const ReferenceMesh& reference;
  std::span<const Index> owner;  ///< for each reference vertex its triangle, or kNone
  float expected;                ///< the distance within which faces have ways
};

/// `halved`: faces that have no ways, sorted; `gaps`: see Gap. Cost: a union-find of the triangles
/// on one thread, with gaps two, and a pass over the faces, with another one as long as the vertex
/// tried of some component tells nothing.
[[nodiscard]] Uncovered findUncovered(const Measuring& measuring, const std::vector<Index>& halved,
                                      const std::vector<Gap>& gaps, base::Job& job);

/// Finds the faces of some that may be the nearest to a point of a triangle.
class FacesNear {
 public:
  FacesNear(const ReferenceMesh& reference, std::vector<Index> faces, base::Job& job);
  /// The one nearest to the triangle's middle first.
  [[nodiscard]] std::vector<Index> of(const std::array<Vec3f, 3>& triangle) const;

 private:
  const ReferenceMesh& reference_;
  std::vector<Index> faces_;
  base::Bvh tree_;
};

}  // namespace tufa::reduce
