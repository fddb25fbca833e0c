#pragma once

#include <tufa/contour.h>
#include <tufa/extract.h>

#include "base/job.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// Marching tetrahedra (Doi and Koide, "An efficient method of triangulating equi-valued surfaces
/// by using tetrahedral cells", 1991) by one of four splits of the cells:
///
/// * MarchingTetrahedra5 and 6: of the cube alone (Carr, Moller and Snoeyink, "Artifacts caused by
///   simplicial subdivision", 2006, compare them and the next);
/// * MarchingTetrahedra24: through the centres of faces and cells;
/// * BodyCentred: of the body-centred cubic lattice (Chan and Purisima, "A new tetrahedral
///   tesselation scheme for isosurface generation", 1998).
///
/// The surface is that of the piecewise linear interpolant of samples and centres; a centre's value
/// is the mean of the samples around it, which is the trilinear one. It has no ambiguous cases: the
/// rule for ambiguous faces means nothing here. Positions are counted from the volume's
/// affine.origin(). Sets what `report` says of cells.
[[nodiscard]] Mesh meshTetrahedra(const grid::Volume& volume, Method method,
                                  const ContourOptions& options, ContourReport& report,
                                  base::Job& job);

}  // namespace tufa::extraction
