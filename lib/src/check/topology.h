#pragma once

#include <tufa/check.h>
#include <cstddef>
#include <vector>

#include "base/job.h"
#include "check/faces.h"

namespace tufa::checks {

/// The connected components of a mesh: vertices are in one if a chain of faces joins them.
struct Pieces {
  static constexpr VertexIndex kNone = ~VertexIndex{0};
  /// For each position its component, an index into CheckReport::components; kNone if no face uses
  /// it.
  std::vector<VertexIndex> ofVertex;
  std::size_t count = 0;
};

/// Fills in what the indices alone tell: counts of edges, vertices, boundaries, duplicates and
/// components, and the verdicts closed, manifold and oriented.
Pieces analyseTopology(const Faces& faces, base::Job& job, CheckReport& report);

}  // namespace tufa::checks
