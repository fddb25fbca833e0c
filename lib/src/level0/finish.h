#pragma once

#include <tufa/contour.h>
#include <cstdint>
#include <vector>

#include "level0/level0.h"

namespace tufa::level0 {

/// Where the elements of a mesh come from. Empty: the mesh is the level-0 mesh.
struct Origins {
  std::vector<VertexIndex> vertices;  ///< base vertex of each vertex, or forest::kNone
  std::vector<std::uint32_t> quads;   ///< base quad of each polygon, quads first
};

/// The last step of every mesh: to world space, to single precision where that moves nothing far,
/// and without the self-intersections that only further vertices, or that rounding, leave. Replaces
/// the normals if options ask for others than the gradient's. `suspects`, sorted, holds a polygon
/// of every pair there may be. Adds to the counts of the repair in `report`.
template <class TreeT>
void finishMesh(const Level0<TreeT>& level0, const ContourOptions& options, const Origins& origins,
                const std::vector<mend::PolygonIndex>& suspects, Mesh& mesh, ContourReport& report,
                base::Job& job);

}  // namespace tufa::level0
