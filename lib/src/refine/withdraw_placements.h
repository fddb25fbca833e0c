#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/job.h"
#include "intersect/surface.h"
#include "uniform/uniform_surface.h"

namespace tufa::refine {

/// What withdrawPlacements() found and did.
struct Withdrawal {
  std::size_t pairsFound = 0;  ///< pairs of quads that intersected with all placements
  std::size_t vertices = 0;    ///< vertices that were moved
  std::size_t left = 0;        ///< folds and pairs all of whose vertices are at their mass points
  /// Pairs of quads that intersect still, all of their vertices at their mass points, or may once
  /// each vertex moves by half of the margin.
  intersect::ClosePairs pairs;
};

/// Accepts as many places of vertices as stand together: withdraws those that fold the surface or
/// make it intersect, until none does.
///
/// Each vertex has three places: the one at a crease that was chosen for it alone, without a look
/// at its neighbours; the point of its QEF in its cell; its mass point. All vertices begin at the
/// first. A conflict is an edge folded by more than 140 degrees, unless two sheets known at both of
/// its ends are as sharp; a pair of quads that intersect; or two vertices of a quad at one point of
/// a crease, or near each other on it with a face between them turned over. Of all moves of its
/// vertices towards their next places the smallest one that settles it is made, or else the
/// smallest to such a place. Only what touches a moved vertex is looked at again.
///
/// It ends, as a vertex moves a bounded number of times. What is decided in a round depends on what
/// is within two cells, and few places take more than three rounds. Pairs of vertices at their mass
/// points are left for repair; few inputs but noise have any. `margin`: as for findCandidates().
/// Cost: one pass over the triangles, one over the quads, and a search for pairs among the
/// candidates.
///
/// `afterwards`, if there is one, is called once all is settled. It may move vertices, and returns
/// which; what they touch is settled in turn, and it is called again, a few times at most.
[[nodiscard]] Withdrawal withdrawPlacements(
    uniform::UniformSurface& surface, double margin, base::Job& job,
    const std::function<std::vector<VertexIndex>()>& afterwards = {});

}  // namespace tufa::refine
