#pragma once

#include <tufa/mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"

namespace tufa::extraction {

/// Index of an edge of a triangle mesh, in the order of its vertices.
using EdgeIndex = std::uint32_t;

/// The edges of a triangle mesh, each once, with the triangles around it.
class TriangleEdges {
 public:
  /// Throws Error(LimitExceeded) for 2^32 edges or more.
  TriangleEdges(const std::vector<Triangle>& triangles, base::Job& job);

  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  /// The two vertices of an edge, the lower first.
  [[nodiscard]] const std::array<VertexIndex, 2>& ends(EdgeIndex edge) const { return ends_[edge]; }
  /// The edges of a triangle: from corner i to corner i + 1.
  [[nodiscard]] const std::array<EdgeIndex, 3>& sides(std::size_t triangle) const {
    return sides_[triangle];
  }
  /// The triangles that have an edge.
  [[nodiscard]] std::span<const std::uint32_t> around(EdgeIndex edge) const {
    return {around_.data() + first_[edge], first_[edge + 1] - first_[edge]};
  }

 private:
  std::vector<std::array<VertexIndex, 2>> ends_;
  std::vector<std::array<EdgeIndex, 3>> sides_;
  std::vector<std::size_t> first_;     ///< of each edge in around_, and the end
  std::vector<std::uint32_t> around_;  ///< triangles, edge by edge
};

}  // namespace tufa::extraction
