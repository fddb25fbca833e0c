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

/// `owner`: for each reference vertex the triangle that answers for it, or kNone; `expected`: the
/// distance within which faces have ways. Cost: one pass over the triangles and one over the faces.
[[nodiscard]] Uncovered findUncovered(const OverlaySurface& overlay,
                                      const CornersOfVertices& corners,
                                      const ReferenceMesh& reference, std::span<const Index> owner,
                                      float expected, base::Job& job);

/// Finds the faces of some that may be the nearest to a point of a triangle.
class FacesNear {
 public:
  FacesNear(const ReferenceMesh& reference, std::vector<Index> faces, base::Job& job);
  [[nodiscard]] std::vector<Index> of(const std::array<Vec3f, 3>& triangle) const;

 private:
  const ReferenceMesh& reference_;
  std::vector<Index> faces_;
  base::Bvh tree_;
};

}  // namespace tufa::reduce
