#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/bvh.h"
#include "base/job.h"
#include "reduce/overlay_surface.h"
#include "reduce/reference_mesh.h"

namespace tufa::reduce {

/// All triangles of those closed components at which the degree of the map of certify() is not one
/// or cannot be counted, as there is no vertex around which all faces have ways; see map_degree.h.
struct Uncovered {
  std::vector<Index> triangles;
  std::vector<Index> faces;  ///< those of the reference that go to these components
};

/// `owner`: for each reference vertex the triangle that answers for it, or kNone; `gaps`: triangles
/// where the map may jump, at which nothing is counted; `expected`: the distance within which faces
/// have ways. Cost: a union-find of the triangles on one thread, and a pass over the faces, with
/// another one as long as the vertex tried of some component tells nothing.
[[nodiscard]] Uncovered findUncovered(const OverlaySurface& overlay,
                                      const CornersOfVertices& corners,
                                      const ReferenceMesh& reference, std::span<const Index> owner,
                                      std::span<const Index> gaps, float expected, base::Job& job);

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
