#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "octree/cluster_forest.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"
#include "uniform/surface_view.h"

namespace tufa::intersect {

/// For each polygon of a cut's mesh whether it may intersect another one elsewhere than in what
/// they share. All others intersect each other nowhere else, even if each vertex moves by half of
/// `margin` (world units).
///
/// The envelopes of findCandidates(), for cells of all sizes (Ju and Udeshi 2006). A polygon stands
/// around the lattice edge from a to b of its uniform quad, in three or four cells. Where v and w
/// are its vertices in neighbouring cells of one size, the segment between them passes the face
/// that both share; where the sizes differ, that is tested. The tetrahedron (a, b, v, w) is then
/// two cones over the triangle (a, b, q), q being the point where the segment passes the face. In
/// one face these triangles have q in common and lie over different stretches of its rim, so they
/// share no inner point, and neither do the envelopes. The rest is as for the uniform mesh.
///
/// Candidates are polygons that fail one of these tests or that have a vertex out of its cell or in
/// a cell of several. Cost: one pass over the vertices, and one over the polygons.
[[nodiscard]] std::vector<std::uint8_t> findCutCandidates(const octree::ClusterForest& forest,
                                                          const octree::Cut& cut,
                                                          const octree::CutMesh& made,
                                                          const uniform::SurfaceView& base,
                                                          double margin, base::Job& job);

}  // namespace tufa::intersect
