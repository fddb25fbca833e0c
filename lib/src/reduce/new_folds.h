#pragma once

#include <vector>

#include "base/job.h"
#include "reduce/reference_mesh.h"
#include "reduce/surface.h"

namespace tufa::reduce {

/// Faces of the reference near folds of a surface that the reference does not have. A fold is an
/// edge between triangles of more than 0.05 square voxels whose normals are more than 150 degrees
/// apart. The reference has it if around the middle of the edge, within three voxels, or one more
/// than the `tolerance` that the surface was reduced to, it has two faces whose normals are as far
/// apart, each within 35 degrees of one of the triangles', as on a wedge of the solid. None for an
/// edge whose ends are over no face. Cost: one pass over the triangles, and of each fold one over
/// the faces of the reference along its edge.
[[nodiscard]] std::vector<Index> facesAtNewFolds(const Surface& surface,
                                                 const ReferenceMesh& reference, float tolerance,
                                                 base::Job& job);

}  // namespace tufa::reduce
