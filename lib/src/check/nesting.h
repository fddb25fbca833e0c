#pragma once

#include "base/bvh.h"
#include "base/job.h"
#include "check/faces.h"
#include "check/topology.h"

namespace tufa::checks {

using base::Bvh;

/// How the directions of the pieces of a closed, oriented mesh fit their nesting.
struct Nesting {
  /// Outermost pieces face outward, and directions alternate from each piece to those inside it.
  bool outward = false;
  /// The same, or all of it turned inside out: the pieces bound one set of solids.
  bool alternates = false;
};

/// Finds for each piece whether an odd number of others hold it, by vertical rays (exact) from some
/// of its vertices, and its direction by the sign of its volume. Where pieces intersect the
/// majority of those vertices decides.
[[nodiscard]] Nesting studyNesting(const Faces& faces, const Pieces& pieces, const Bvh& tree,
                                   base::Job& job);

}  // namespace tufa::checks
