#pragma once

#include <array>
#include <vector>

#include "octree/cut.h"
#include "refine/cut_triangles.h"
#include "uniform/surface_view.h"

namespace tufa::refine {

/// Pairs of triangles that fold a cut: whose normals are more than 150 degrees apart, each of more
/// than 0.05 square voxels. Not where the surface is that sharp: where both ends of their edge
/// stand for vertices at which the samples show two such sheets, one for each. Between 148 and
/// 150.5 degrees sheets as sharp excuse faces of up to 150.
[[nodiscard]] std::vector<std::array<reduce::Index, 2>> findFolds(const CutTriangles& triangles,
                                                                  const octree::Cut& cut,
                                                                  const uniform::SurfaceView& base,
                                                                  base::Job& job);

}  // namespace tufa::refine
