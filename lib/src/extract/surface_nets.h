#pragma once

#include <tufa/contour.h>

#include "base/job.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// Surface nets (Gibson, "Constrained elastic surface nets: generating smooth surfaces from binary
/// segmented data", 1998), without the relaxation that binary data needs: the cells and quads of
/// dual contouring, each vertex at the mean of the crossings around it. Positions are counted from
/// the volume's affine.origin(). Sets what `report` says of cells.
[[nodiscard]] Mesh meshSurfaceNets(const grid::Volume& volume, const ContourOptions& options,
                                   ContourReport& report, base::Job& job);

}  // namespace tufa::extraction
