#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"

namespace tufa::reduce {

/// Number of a vertex, a triangle, a corner or a part.
using Index = std::uint32_t;
inline constexpr Index kNone = ~Index{0};

// Corners are numbered 3 * triangle + i. A corner also stands for the edge opposite it, which runs
// from the next corner to the previous one (a corner table; Rossignac 2001).

[[nodiscard]] inline Index nextCorner(Index c) { return c % 3 == 2 ? c - 2 : c + 1; }
[[nodiscard]] inline Index previousCorner(Index c) { return c % 3 == 0 ? c + 2 : c - 1; }

/// For each vertex the corners at it, in rising order.
struct CornersOfVertices {
  CornersOfVertices(std::size_t vertexCount, std::span<const Triangle> triangles);
  [[nodiscard]] std::span<const Index> of(Index vertex) const {
    return {corners.data() + first[vertex], corners.data() + first[vertex + 1]};
  }
  std::vector<Index> first;
  std::vector<Index> corners;
};

/// The corner across the edge of a corner, or kNone at a border. Where several are, the last one.
[[nodiscard]] inline Index oppositeCorner(std::span<const Triangle> triangles,
                                          const CornersOfVertices& corners, Index c) {
  const auto at = [&](Index corner) { return triangles[corner / 3].vertices[corner % 3]; };
  const Index from = at(nextCorner(c));
  Index opposite = kNone;
  for (const Index d : corners.of(at(previousCorner(c)))) {
    if (at(nextCorner(d)) == from) opposite = previousCorner(d);
  }
  return opposite;
}

/// That of every corner.
[[nodiscard]] std::vector<Index> oppositeCorners(std::span<const Triangle> triangles,
                                                 const CornersOfVertices& corners, base::Job& job);

}  // namespace tufa::reduce
