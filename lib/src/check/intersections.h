#pragma once

#include <cstddef>

#include "base/bvh.h"
#include "base/job.h"
#include "check/faces.h"

namespace tufa::checks {

using base::Box;
using base::Bvh;

/// A tree over faces.solid(), item i being face i.
[[nodiscard]] Bvh buildFaceTree(const Faces& faces, base::Job& job);

/// The number of pairs of faces that intersect elsewhere than in the vertices or the edge whose
/// indices they share.
///
/// Agrees with CGAL's self_intersections() wherever that can be asked, apart from its pairs (f, f):
/// collinear faces are left out here, and counted as degenerate instead. Takes any mesh: two faces
/// with the same three vertices are a pair, faces that touch without sharing an index are too.
[[nodiscard]] std::size_t countIntersectingPairs(const Faces& faces, const Bvh& tree,
                                                 base::Job& job);

}  // namespace tufa::checks
