#pragma once

#include <tufa/contour.h>

#include "extract/cube_cells.h"

namespace tufa::extraction {

/// Marching cubes (Lorensen and Cline, "Marching cubes: a high resolution 3D surface construction
/// algorithm", 1987), with the faces of cells joined by one of the rules.
///
/// The paper's table takes 15 cases and their complements, by which two cells may join the face
/// between them in different ways: Ambiguity::Original. By any other rule both cells do the same on
/// their face, which makes the mesh closed. It is also a 2-manifold: no triangle has an edge inside
/// a face but the arcs that both cells share (Wenger, "Isosurfaces", 2013).
[[nodiscard]] CubeRule marchingCubesRule(Ambiguity rule);

/// The ambiguous faces of a cell that Ambiguity::Asymptotic joins.
[[nodiscard]] FaceBits facesJoinedBySaddles(CornerMask mask, const CornerValues& values);

}  // namespace tufa::extraction
