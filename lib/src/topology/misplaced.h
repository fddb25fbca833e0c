#pragma once

#include <tufa/mesh.h>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "base/job.h"

namespace tufa::topology {

/// For each vertex the lowest-numbered vertex of its connected component.
[[nodiscard]] std::vector<VertexIndex> connectedComponentsOf(const Mesh& mesh);

/// What is known of a mesh that was cut out of a closed one between two planes across an axis.
struct OpenMesh {
  int axis = 2;
  bool isHoleOutermost = false;  ///< what lies in no other component faces inward
  /// Whether a vertex is so near to an end that its component may be cut off there.
  std::function<bool(const Position&)> isNearEnd;
};

/// Finds components on the wrong side of another one: the vertices of those components of a closed
/// mesh, and the vertices of the polygons of other components nearest to them; sorted. A vertex
/// that was moved may have passed a small component without intersecting it, so that no search for
/// intersections finds it.
///
/// Directions must alternate from the outermost components inward, and the component of the largest
/// volume, which lies in no other, tells what the outermost direction is. So a component is right
/// if the number of others around it is odd exactly if its volume has the other sign. Components
/// that intersect others are not reported; they are left to repair. Every component that lies
/// wholly on the wrong side is found, but for those of more than `mostVertices`. With them are the
/// vertices of components no thicker than `thinnest`, above 0: rounding may turn those over.
///
/// `open`: for a mesh that is a part of a closed one. Components near an end are not looked at.
///
/// Cost: one pass for components, one for volumes, one for areas with `thinnest`, and one for a ray
/// from each component that is small enough; one pass if there is only one component. More where
/// some seem wrong.
[[nodiscard]] std::vector<VertexIndex> findMisplaced(
    const Mesh& mesh, base::Job& job,
    std::size_t mostVertices = std::numeric_limits<std::size_t>::max(), double thinnest = 0,
    const OpenMesh* open = nullptr);

}  // namespace tufa::topology
