#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/triangle_array.h"

namespace tufa::reduce {

/// Number of a vertex, a triangle, a corner or a part.
using Index = std::uint32_t;
inline constexpr Index kNone = ~Index{0};

// Corners are numbered 3 * triangle + i. A corner also stands for the edge opposite it, which runs
// from the next corner to the previous one (a corner table; Rossignac 2001).

[[nodiscard]] inline Index nextCorner(Index c) { return c % 3 == 2 ? c - 2 : c + 1; }
[[nodiscard]] inline Index previousCorner(Index c) { return c % 3 == 0 ? c + 2 : c - 1; }

/// For each vertex the corners at it, in rising order: of all vertices, or of a range of them.
class CornersOfVertices {
 public:
  CornersOfVertices(std::size_t vertexCount, const base::TriangleView& triangles, base::Job& job);
  [[nodiscard]] Index begin() const { return begin_; }
  [[nodiscard]] Index end() const { return begin_ + static_cast<Index>(first_.size() - 2); }
  [[nodiscard]] std::span<const Index> of(Index vertex) const {
    const Index* const first = first_.data() + (vertex - begin_);
    return {corners_.data() + first[0], corners_.data() + first[1]};
  }

 private:
  friend class CornerRanges;
  /// forTriangles(body) calls body(t) for triangles in rising order, those of all corners wanted
  /// among them.
  template <class ForTriangles>
  CornersOfVertices(Index begin, Index end, const base::TriangleView& triangles,
                    const ForTriangles& forTriangles);

  Index begin_;
  std::vector<Index> first_;
  std::vector<Index> corners_;
};

/// The vertices of a mesh in ranges, so that corners are found range by range: a fraction of the
/// memory of all, and on several threads at a time.
class CornerRanges {
 public:
  CornerRanges(std::size_t vertexCount, const base::TriangleView& triangles, base::Job& job);
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] CornersOfVertices operator[](std::size_t range) const;

 private:
  std::size_t vertexCount_;
  base::TriangleView triangles_;
  int shift_;
  std::size_t size_;
  std::vector<std::uint64_t> reached_;  ///< of each block of triangles a bit for each range
};

/// Calls body(corners) for ranges that all vertices are in, in parallel.
template <class Body>
void forCornerRanges(std::size_t vertexCount, const base::TriangleView& triangles, base::Job& job,
                     const Body& body) {
  const CornerRanges ranges(vertexCount, triangles, job);
  job.forRanges(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t range = begin; range < end; ++range) body(ranges[range]);
  });
}

/// All triangles that have a vertex in common with one of these, in rising order.
[[nodiscard]] std::vector<Index> trianglesAround(const base::TriangleView& triangles,
                                                 const CornersOfVertices& corners,
                                                 std::span<const Index> some);

/// Calls set(corner, other) for the corners that follow those at some vertices in their triangles,
/// other being the one across the edge, or kNone at a border; where several are, the last one. An
/// edge that comes from another vertex meets the one that goes back there.
template <class Set>
void forOppositeCorners(const base::TriangleView& triangles, const CornersOfVertices& corners,
                        Index begin, Index end, const Set& set) {
  std::vector<Index> nextVertices;
  for (Index v = begin; v < end; ++v) {
    const std::span<const Index> around = corners.of(v);
    nextVertices.clear();
    for (const Index c : around) {
      const Index next = nextCorner(c);
      nextVertices.push_back(triangles.corner(next));
    }
    for (const Index c : around) {
      const Index previous = previousCorner(c);
      const Index from = triangles.corner(previous);
      Index other = kNone;
      for (std::size_t i = 0; i < around.size(); ++i) {
        if (nextVertices[i] == from) other = previousCorner(around[i]);
      }
      set(nextCorner(c), other);
    }
  }
}

/// That of every corner.
[[nodiscard]] std::vector<Index> oppositeCorners(const base::TriangleView& triangles,
                                                 const CornersOfVertices& corners, base::Job& job);

}  // namespace tufa::reduce
