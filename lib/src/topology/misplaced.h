#pragma once

#include <tufa/mesh.h>
#include <vector>

#include "base/job.h"

namespace tufa::topology {

/// For each vertex the least one of its connected piece of surface.
[[nodiscard]] std::vector<VertexIndex> connectedComponentsOf(const Mesh& mesh);

/// Vertices of the pieces of a closed mesh that lie on the wrong side of another one, and of the
/// polygons of other pieces that are nearest to them; sorted. Directions must alternate from the
/// outermost pieces to those inside them; the largest piece tells whether they begin outward. A
/// surface that was moved may have passed a small piece without meeting it. Pieces that meet
/// others are not named.
[[nodiscard]] std::vector<VertexIndex> findMisplaced(const Mesh& mesh, base::Job& job);

}  // namespace tufa::topology
