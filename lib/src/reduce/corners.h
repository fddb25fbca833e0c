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
  CornersOfVertices(std::size_t vertexCount, std::span<const Triangle> triangles, base::Job& job);
  [[nodiscard]] std::size_t vertexCount() const { return first.size() - 2; }
  [[nodiscard]] std::span<const Index> of(Index vertex) const {
    return {corners.data() + first[vertex], corners.data() + first[vertex + 1]};
  }
  std::vector<Index> first;
  std::vector<Index> corners;
};

/// All triangles that have a vertex in common with one of these, in rising order.
[[nodiscard]] std::vector<Index> trianglesAround(std::span<const Triangle> triangles,
                                                 const CornersOfVertices& corners,
                                                 std::span<const Index> some);

/// Calls set(corner, other) for every corner, other being the one across its edge, or kNone at a
/// border; where several are, the last one. In parallel. Vertex by vertex: an edge that comes from
/// another vertex meets the one that goes back there.
template <class Set>
void forOppositeCorners(std::span<const Triangle> triangles, const CornersOfVertices& corners,
                        base::Job& job, const Set& set) {
  constexpr std::size_t kGrain = 4096;
  job.forRanges(corners.vertexCount(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Index> nextVertices;
    for (std::size_t v = begin; v < end; ++v) {
      const std::span<const Index> around = corners.of(static_cast<Index>(v));
      nextVertices.clear();
      for (const Index c : around) {
        const Index next = nextCorner(c);
        nextVertices.push_back(triangles[next / 3].vertices[next % 3]);
      }
      for (const Index c : around) {
        const Index previous = previousCorner(c);
        const Index from = triangles[previous / 3].vertices[previous % 3];
        Index other = kNone;
        for (std::size_t i = 0; i < around.size(); ++i) {
          if (nextVertices[i] == from) other = previousCorner(around[i]);
        }
        set(nextCorner(c), other);
      }
    }
  });
}

/// That of every corner.
[[nodiscard]] std::vector<Index> oppositeCorners(std::span<const Triangle> triangles,
                                                 const CornersOfVertices& corners, base::Job& job);

}  // namespace tufa::reduce
