#pragma once

#include "extract/cube_cells.h"

namespace tufa::extraction {

/// Marching cubes with the topology of the trilinear interpolant: Chernyaev, "Marching cubes 33:
/// construction of topologically correct isosurfaces", 1995, as corrected by Custodio et al.,
/// "Practical considerations on marching cubes 33 topological correctness", 2013, and by Grosso and
/// Zidan, "TMC: topologically correct marching cubes", 2022.
///
/// Faces are joined by their saddles, and loops by a tunnel if the trilinear surface has one in the
/// cell. Corner mask, face bits and tunnel are an index into the table of cases; there is no
/// classification into 33.
[[nodiscard]] CubeRule mc33Rule();

/// The tunnel in a cell, or 0: see codeOf(). `joined` are the bits of the ambiguous faces.
///
/// Sweeps the cell by slices across its first axis. A slice is bilinear, with corners that are
/// linear in its height: what its curves join changes only where a corner changes sign or, if all
/// four alternate, where the saddle does. The ends of the curves run on the faces of the cell and
/// so tell the loops they belong to: where a curve joins two loops there is a tunnel. The saddle
/// changes sign with a quadratic function of the height, whose sign at both ends of a run of
/// alternating slices and at its extremum tells all.
[[nodiscard]] int tunnelOf(CornerMask mask, FaceBits joined, const CornerValues& values);

}  // namespace tufa::extraction
