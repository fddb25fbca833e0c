#include "reduce/corners.h"

#include "base/huge_pages.h"
#include "base/sort_unique.h"

namespace tufa::reduce {

std::vector<Index> oppositeCorners(std::span<const Triangle> triangles,
                                   const CornersOfVertices& corners, base::Job& job) {
  std::vector<Index> opposite;
  base::resizeLarge(opposite, 3 * triangles.size(), job);
  forOppositeCorners(triangles, corners, job,
                     [&](Index corner, Index other) { opposite[corner] = other; });
  return opposite;
}

std::vector<Index> trianglesAround(std::span<const Triangle> triangles,
                                   const CornersOfVertices& corners, std::span<const Index> some) {
  std::vector<Index> around;
  for (const Index t : some) {
    for (const Index v : triangles[t].vertices) {
      for (const Index c : corners.of(v)) around.push_back(c / 3);
    }
  }
  base::sortUnique(around);
  return around;
}

CornersOfVertices::CornersOfVertices(std::size_t vertexCount, std::span<const Triangle> triangles,
                                     base::Job& job) {
  base::resizeLarge(first, vertexCount + 2, job);
  base::resizeLarge(corners, 3 * triangles.size(), job);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    job.pollCancelled(t);
    for (const Index v : triangles[t].vertices) ++first[v + 2];
  }
  for (std::size_t i = 0; i < vertexCount; ++i) first[i + 2] += first[i + 1];
  for (Index c = 0; c < corners.size(); ++c) {
    job.pollCancelled(c);
    corners[first[triangles[c / 3].vertices[c % 3] + 1]++] = c;
  }
}

}  // namespace tufa::reduce
