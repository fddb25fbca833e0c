#pragma once

#include <tufa/mesh.h>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/job.h"
#include "check/faces.h"

namespace tufa::checks {

/// The faces around each vertex, in the order of the mesh.
class VertexFaces {
 public:
  VertexFaces(const std::vector<Triangle>& faces, std::size_t vertexCount);

  [[nodiscard]] std::size_t vertexCount() const { return offsets_.size() - 1; }
  [[nodiscard]] const std::uint32_t* begin(std::size_t vertex) const {
    return faceIndices_.data() + offsets_[vertex];
  }
  [[nodiscard]] const std::uint32_t* end(std::size_t vertex) const {
    return faceIndices_.data() + offsets_[vertex + 1];
  }

 private:
  std::vector<std::size_t> offsets_;
  std::vector<std::uint32_t> faceIndices_;
};

/// Counts around one vertex. Each edge is counted at the smaller of its two vertices, and each face
/// at the smallest of its three, so sums over vertices count everything once.
struct StarCounts {
  std::uint32_t edges = 0;
  std::uint32_t boundaryEdges = 0;
  std::uint32_t nonManifoldEdges = 0;
  std::uint32_t misorientedEdges = 0;
  std::uint32_t duplicateFaces = 0;
  bool isFan = true;  ///< the faces form one closed or open fan
};

/// Analyses the stars of all vertices, one record for each vertex. Boundary edges are added to
/// `boundaryEdges` as pairs (smaller, larger vertex), in increasing order.
[[nodiscard]] std::vector<StarCounts> studyStars(
    const std::vector<Triangle>& faces, const VertexFaces& around, base::Job& job,
    std::vector<std::pair<VertexIndex, VertexIndex>>& boundaryEdges);

}  // namespace tufa::checks
