#pragma once

#include "base/bvh.h"
#include "base/job.h"
#include "check/faces.h"
#include "check/topology.h"

namespace tufa::checks {

using base::Bvh;

/// How the directions of the connected components of a closed, oriented mesh fit their nesting.
struct Nesting {
  /// Outermost components face outward, and directions alternate from each component to those
  /// inside it.
  bool outward = false;
  /// The same, or the whole mesh inside out: the components bound one set of solids.
  bool alternates = false;
};

/// Finds for each component whether it lies inside an odd number of others, by exact vertical rays
/// from some of its vertices, and its direction by the sign of its volume. Where components
/// intersect, the majority of those vertices decides; those that lie on other components do not
/// count.
[[nodiscard]] Nesting studyNesting(const Faces& faces, const Pieces& pieces, const Bvh& tree,
                                   base::Job& job);

}  // namespace tufa::checks
