#pragma once

#include <tufa/mesh.h>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/job.h"
#include "chunks/cut/moved_vertex.h"

namespace tufa::chunks {

/// How far a mesh is from what it was made of, triangle by triangle.
///
/// There is a number for each vertex. Every point of a triangle is within the largest one of its
/// corners of the surface that came first, and so is every point of that of some triangle.
class SurfaceMoves {
 public:
  /// What changes at a time.
  enum class Kind {
    Places,    ///< vertices move, each by so much
    Triangles  ///< edges around vertices are collapsed or flipped, which moves points by so much
  };

  /// Memory for `room` vertices, of which there are `count`.
  void reserve(std::size_t count, std::size_t room, base::Job& job);
  /// Adds a vertex inside an edge.
  void addBetween(VertexIndex a, VertexIndex b) { by_.push_back(std::max(by_[a], by_[b])); }
  /// `before`: the triangles before the change. Cost: a pass over these, and some over those at the
  /// vertices.
  void add(Kind kind, const std::vector<Triangle>& before, const std::vector<MovedVertex>& changes,
           base::Job& job);
  /// For all vertices of triangles that are anywhere else than the first surface how far those are
  /// at most. Rising.
  [[nodiscard]] std::vector<MovedVertex> take(const std::vector<Triangle>& triangles,
                                              base::Job& job);

 private:
  std::vector<float> by_;  // rounded up
};

}  // namespace tufa::chunks
