#pragma once

#include <tufa/contour.h>

#include "certify/certificate.h"
#include "cut/leaves.h"
#include "forest/forest.h"
#include "polygons/cut_polygons.h"

namespace tufa::certify {

/// The coarsest mesh found that keeps a rule, and how far it is from the base mesh.
struct AdaptiveMesh {
  Mesh mesh;
  std::vector<LeafCell> leaves;  ///< surface cells that are leaves, by level
  double largestError = 0;       ///< voxels
  double meanError = 0;          ///< voxels
  int rounds = 0;                ///< meshes made and measured
};

/// Cuts the forest, makes the mesh, measures it, splits the cells where it is off by more than the
/// tolerance, and starts again until there are none.
template <class TreeT>
[[nodiscard]] AdaptiveMesh adapt(const forest::Base<TreeT>& base, const forest::Forest& forest,
                                 const cut::CutRule& rule, base::Job& job);

/// The certificate of an adaptive mesh; `voxelSize` is in world units. Takes the leaves over if
/// they are to be kept.
[[nodiscard]] Certificate certificateOf(AdaptiveMesh& adaptive, double voxelSize, bool keepLeaves);

}  // namespace tufa::certify
