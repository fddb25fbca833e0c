#pragma once

#include "base/vec3.h"
#include "octree/cluster_forest.h"
#include "refine/measured.h"

namespace tufa::refine {

/// A piece of surface that a mesh was made without.
struct Dropped {
  Vec3 centre{0.0};  ///< of its bounding box, world space
  double size = 0;   ///< diagonal of that box, voxels
};

/// Takes the polygons of connected components out of a mesh whose base vertices lie in a box with a
/// diagonal of at most the rule's tolerance there, all but the component of most base vertices.
/// Their vertices stay, without polygons. Appends what was taken out, in the order of the vertices.
///
/// Returns the size in voxels of the smallest component that stayed and might go with a larger
/// tolerance; 0 if there is none.
double dropComponents(const uniform::SurfaceView& base, const octree::CutRule& rule, Measured& mesh,
                      std::vector<Dropped>& dropped);

/// Removes vertices that no polygon uses; `baseVertices` goes with the positions. Returns which of
/// the vertices were used.
std::vector<std::uint8_t> removeUnused(Mesh& mesh, std::vector<VertexIndex>& baseVertices);

}  // namespace tufa::refine
