#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"
#include "octree/cut_rule.h"
#include "refine/cut_owners.h"
#include "uniform/surface_view.h"

namespace tufa::refine {

/// How far a mesh taken from a cut is from the uniform mesh, voxels.
struct Deviation {
  double largest = 0;  ///< a bound, both ways
  double mean = 0;     ///< over the vertices of the uniform mesh
};

/// Measures meshes taken from cuts against the uniform mesh that they come from, as
/// reduce::certify() does: every uniform vertex goes to the nearest point of its owner, a triangle
/// around its cluster, and every uniform edge over triangles that lie within the tolerance of it.
/// So the largest distance is a bound, both ways, for what findUncovered() finds covered. A uniform
/// face without such a way is too far.
///
/// From one mesh to the next only what changed is measured again. The way of an edge leads over
/// triangles that have a vertex in common with the owner of one of its ends. So it is as it was
/// unless something changed around these.
///
/// Cost: about half a microsecond a uniform vertex at first.
class CutDistance {
 public:
  /// `base` is the uniform mesh, `frame` that of its positions. They, the rule and `job` must
  /// outlive this object.
  CutDistance(const uniform::SurfaceView& base, const LocalFrame& frame,
              const octree::CutRule& rule, base::Job& job);

  /// Measures the next mesh. `changed`: for each vertex of the cut, whether it is not as in the
  /// mesh before; for the first one, whether its cell is larger than a voxel. Returns the vertices
  /// whose cells must be split for the tolerance, or as they fold the mesh, sorted.
  [[nodiscard]] std::vector<VertexIndex> measure(const octree::Cut& cut,
                                                 const octree::CutMesh& made,
                                                 const std::vector<std::uint8_t>& changed);

  /// Closed components of the mesh measured last that the uniform mesh may leave out in part: those
  /// too thin for the distance forth to bound the way back; see reduce/map_degree.h. Returns their
  /// vertices in the largest cells, sorted. Those that stay, as cells may not be split, total()
  /// measures both ways.
  [[nodiscard]] std::vector<VertexIndex> findUncovered(const octree::Cut& cut,
                                                       const octree::CutMesh& made);

  /// How far the mesh measured last is, without components that were left out since. Where cells
  /// were not split that had to be, all is measured anew.
  [[nodiscard]] Deviation total(const octree::Cut& cut, const Mesh& mesh) const;

 private:
  [[nodiscard]] Deviation measureWhole(const octree::Cut& cut, const Mesh& mesh,
                                       float expected) const;

  CutOwners owners_;
  bool isUncovered_ = false;  ///< whether findUncovered() last left a component unsettled
};

}  // namespace tufa::refine
