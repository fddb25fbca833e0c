#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "base/job.h"
#include "certify/base_surface.h"
#include "cut/cut.h"
#include "forest/forest.h"
#include "polygons/cut_polygons.h"

namespace tufa::certify {

/// A mesh made from a cut, as the certificate sees it.
struct Candidate {
  const cut::Cut& cut;
  const polygons::CutMesh& made;
};

/// How far a mesh is from the base mesh, both ways, and where it is too far.
struct Deviation {
  double largest = 0;  ///< voxels
  double mean = 0;     ///< voxels, over the points of the base mesh
  std::vector<VertexIndex> coarse;  ///< vertices whose cells must be split, sorted
};

/// Measures a mesh against its base mesh: every base vertex and the middle of every base quad against
/// the polygons around its own clusters, and samples of every polygon against the base polygons below
/// it. Each distance is one to a point found, so none is too small. The bound is the rule's tolerance.
template <class TreeT>
[[nodiscard]] Deviation measureDeviation(const forest::Base<TreeT>& base,
                                         const BaseSurface<TreeT>& surface,
                                         const Candidate& candidate,
                                         const cut::CutRule& rule,
                                         base::Job& job);

}  // namespace tufa::certify
