#pragma once

#include "base/vec3.h"
#include "octree/cluster_forest.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"
#include "octree/cut_rule.h"
#include "uniform/surface_view.h"

namespace tufa::refine {

/// A connected component that a mesh was made without.
struct Dropped {
  Vec3 centre{0.0};  ///< of its bounding box, counted as the mesh's positions
  double size = 0;   ///< diagonal of that box, voxels
};

/// Removes the polygons of small connected components from a mesh: those whose uniform vertices lie
/// in a box with a diagonal of at most the rule's tolerance there, except the component of most
/// uniform vertices. Their vertices stay, without polygons. Appends what was removed, in the order
/// of the vertices.
///
/// Returns the size in voxels of the smallest component that stayed and would go with a larger
/// tolerance; 0 if there is none.
double dropComponents(const uniform::SurfaceView& base, const octree::CutRule& rule,
                      const octree::Cut& cut, octree::CutMesh& made, std::vector<Dropped>& dropped);

/// Removes vertices that no polygon uses; `baseVertices` goes with the positions. Returns which of
/// the vertices were used.
std::vector<std::uint8_t> removeUnused(Mesh& mesh, std::vector<VertexIndex>& baseVertices);

}  // namespace tufa::refine
