#include "reduce/corners.h"

#include <array>

namespace tufa::reduce {
namespace {
constexpr std::size_t kGrain = 16384;
}

std::vector<Index> oppositeCorners(std::size_t vertexCount, std::span<const Triangle> triangles,
                                   base::Job& job) {
  const std::size_t corners = triangles.size() * 3;
  std::vector<Index> first(vertexCount + 1, 0), opposite(corners, kNone);
  std::vector<std::array<Index, 2>> edges(corners);  // by start: end and opposite corner
  const auto at = [&](Index c) { return triangles[c / 3].vertices[c % 3]; };
  for (Index c = 0; c < corners; ++c) ++first[at(c) + 1];
  for (std::size_t i = 0; i < vertexCount; ++i) first[i + 1] += first[i];
  for (Index c = 0; c < corners; ++c) {
    edges[first[at(nextCorner(c))]++] = {at(previousCorner(c)), c};
  }
  for (std::size_t i = vertexCount; i > 0; --i) first[i] = first[i - 1];
  first[0] = 0;
  job.forRanges(corners, kGrain, [&](std::size_t begin, std::size_t end) {
    for (Index c = static_cast<Index>(begin); c < end; ++c) {
      const Index from = at(nextCorner(c)), to = at(previousCorner(c));
      for (Index j = first[to]; j < first[to + 1]; ++j) {
        if (edges[j][0] == from) opposite[c] = edges[j][1];
      }
    }
  });
  return opposite;
}

CornersOfVertices::CornersOfVertices(std::size_t vertexCount, std::span<const Triangle> triangles)
    : first(vertexCount + 2, 0), corners(triangles.size() * 3) {
  for (const Triangle& t : triangles) {
    for (const Index v : t.vertices) ++first[v + 2];
  }
  for (std::size_t i = 0; i < vertexCount; ++i) first[i + 2] += first[i + 1];
  for (Index c = 0; c < corners.size(); ++c) {
    corners[first[triangles[c / 3].vertices[c % 3] + 1]++] = c;
  }
}

}  // namespace tufa::reduce
