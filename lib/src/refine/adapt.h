#pragma once

#include <tufa/contour.h>

#include "octree/cluster_forest.h"
#include "octree/leaves.h"
#include "refine/drop_components.h"
#include "refine/extracted_mesh.h"
#include "refine/repair/repair.h"
#include "refine/surface_model.h"

namespace tufa::refine {

/// An adaptive mesh, and how far it is from the uniform mesh.
struct AdaptiveMesh {
  ExtractedMesh extracted;
  std::vector<LeafCell> leaves;  ///< surface cells that are leaves, by level; of a cut
  double largestError = 0;       ///< voxels
  double meanError = 0;          ///< voxels
  int rounds = 0;                ///< meshes made and measured
  std::vector<Dropped> dropped;  ///< components that were left out
};

/// Cuts the forest, makes the mesh, measures it, splits the cells where it is off by more than the
/// tolerance or, if the model repairs, intersects itself, and repeats that until there are none. It
/// ends, as cells are only ever forbidden and the finest cut is the uniform mesh itself. Each time
/// only what has changed is looked at. The model must have clusters. `drop`: leave out components
/// smaller than the tolerance, see dropComponents().
[[nodiscard]] AdaptiveMesh adapt(const SurfaceModel& model, const octree::CutRule& rule, bool drop,
                                 base::Job& job);

/// The certificate of an adaptive mesh; `voxelSize` is in world units. Takes the leaves over if
/// they are to be kept.
[[nodiscard]] Certificate certificateOf(AdaptiveMesh& adaptive, double voxelSize, bool keepLeaves,
                                        base::Job& job);

/// Sets what a certificate tells of the angles of the finished mesh; `minAngle` as in
/// ContourOptions.
void setAngles(Certificate& certificate, const Mesh& mesh, double minAngle);

/// Adds to a certificate what vertices have moved since, in voxels.
void widen(Certificate& certificate, double moved, double voxelSize);

}  // namespace tufa::refine
