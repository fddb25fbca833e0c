#pragma once

#include <tufa/contour.h>

#include "octree/cluster_forest.h"
#include "octree/leaves.h"
#include "refine/drop_components.h"
#include "refine/extracted_mesh.h"
#include "refine/simplify_cut.h"
#include "refine/surface_model.h"

namespace tufa::refine {

/// What adapt() does beside cutting.
struct AdaptOptions {
  const Repair* repair = nullptr;  ///< remove self-intersections; null: leave them
  bool simplify = false;           ///< collapse edges of the cut's mesh, see simplifyCut()
  Goal goal = {};                  ///< how far edges are collapsed
  /// Leave out components smaller than the tolerance, see dropComponents(); for a number of
  /// triangles that cannot be met otherwise, larger ones too, the smallest first.
  bool drop = false;
};

/// The coarsest mesh found that keeps a rule, and how far it is from the uniform mesh.
struct AdaptiveMesh {
  ExtractedMesh extracted;
  std::vector<LeafCell> leaves;  ///< surface cells that are leaves, by level
  double largestError = 0;       ///< voxels
  double meanError = 0;          ///< voxels
  int rounds = 0;                ///< meshes made and measured
  RepairReport repaired;         ///< of the last round
  double tolerance = 0;          ///< voxels; with which edges were collapsed
  std::vector<Dropped> dropped;  ///< components that were left out
};

/// Cuts the forest, makes the mesh, measures it, splits the cells where it is off by more than the
/// tolerance or intersects itself, and repeats that until there are none; then collapses edges.
/// Small changes are tried before a cell is split because of an intersection. It ends, as cells are
/// only ever forbidden and the finest cut is the uniform mesh itself. `kept`, if not null, receives
/// what coarsen() continues from.
[[nodiscard]] AdaptiveMesh adapt(const SurfaceModel& model, const octree::CutRule& rule,
                                 const AdaptOptions& options, base::Job& job,
                                 Measured* kept = nullptr);

/// Collapses edges of a mesh that keeps a finer rule until this one, or the number of triangles,
/// allows no more. `kept` is that mesh and becomes the new one. The result lists no leaves.
[[nodiscard]] AdaptiveMesh coarsen(const SurfaceModel& model, const octree::CutRule& rule,
                                   const AdaptOptions& options, base::Job& job, Measured& kept);

/// The certificate of an adaptive mesh; `voxelSize` is in world units. Takes the leaves over if
/// they are to be kept.
[[nodiscard]] Certificate certificateOf(AdaptiveMesh& adaptive, double voxelSize, bool keepLeaves);

}  // namespace tufa::refine
