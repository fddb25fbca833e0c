#pragma once

#include <tufa/contour.h>

#include "base/job.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// Extended marching cubes (Kobbelt, Botsch, Schwanecke and Seidel, "Feature sensitive surface
/// extraction from volume data", 2001): where the normals at the crossings of a loop of marching
/// cubes differ by more than `sharpAngle` degrees, it is filled by a fan around a vertex at the
/// best point for their tangent planes; where two such loops share an arc of a face, the arc's edge
/// is flipped, so that creases run from vertex to vertex.
///
/// Departures: in distance fields vertices follow the sheets around their cell, and there are more
/// of them, see findSharpLoops(); which directions planes leave free is told by eigenvalues in
/// place of a second angle for corners. The edge of an arc is not flipped where both loops own both
/// arcs of an ambiguous face: there would be an edge of four triangles.
[[nodiscard]] Mesh meshSharp(const grid::Volume& volume, double sharpAngle,
                             const ContourOptions& options, ContourReport& report, base::Job& job);

}  // namespace tufa::extraction
