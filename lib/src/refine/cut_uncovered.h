#pragma once

#include <vector>

#include "octree/cut.h"
#include "octree/cut_polygons.h"
#include "refine/cut_owners.h"

namespace tufa::refine {

/// Closed components of a cut's mesh that the uniform mesh may leave out in part.
struct CutUncovered {
  std::vector<VertexIndex> vertices;  ///< theirs in the largest cells, sorted
  bool isAny = false;                 ///< also if of some component it is not known
};

/// Finds components too thin for the distance of the uniform mesh to bound the way back: those that
/// its faces do not cover exactly once at some vertex of a larger cell; see reduce/map_degree.h.
/// `owners`: of this mesh. Cost: one pass over the faces, and their ways near these vertices.
[[nodiscard]] CutUncovered findCutUncovered(const CutOwners& owners, const octree::Cut& cut,
                                            const octree::CutMesh& made);

}  // namespace tufa::refine
