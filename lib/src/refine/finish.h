#pragma once

#include <tufa/contour.h>

#include "base/job.h"
#include "refine/extracted_mesh.h"
#include "refine/surface_model.h"

namespace tufa::refine {

/// The last step of every mesh: to world space; to single precision where that moves nothing far;
/// and without the self-intersections that rounding makes or only additional vertices remove.
/// Replaces the normals if the options ask for others than the gradient's. Adds to the counts of
/// the repair in `report`. Returns how far the repair has moved a vertex at most, in voxels.
double finishMesh(SurfaceModel& model, const ContourOptions& options, ExtractedMesh& extracted,
                  ContourReport& report, base::Job& job);

}  // namespace tufa::refine
