#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

#include "base/vec3.h"

namespace tufa::refine {

inline constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// The triangles of a mesh while its edges are collapsed, with the vertex that each was joined to.
/// Quads are two triangles each. A triangle is identified by the place of its first corner.
class EdgeMesh {
 public:
  explicit EdgeMesh(const Mesh& mesh);

  [[nodiscard]] std::size_t triangleCount() const { return alive_; }
  /// Number of vertices, and of corners of triangles, of the mesh as it was given.
  [[nodiscard]] std::size_t vertexCount() const { return points_.size(); }
  [[nodiscard]] std::size_t cornerCount() const { return corners_.size(); }
  [[nodiscard]] const Vec3& point(VertexIndex vertex) const { return points_[vertex]; }
  [[nodiscard]] VertexIndex corner(std::size_t place) const { return corners_[place]; }
  [[nodiscard]] bool isAlive(std::size_t triangle) const { return corners_[triangle] != kNone; }
  /// Whether the vertex was joined to no other.
  [[nodiscard]] bool isRoot(VertexIndex vertex) const { return vertexOf_[vertex] == vertex; }
  /// The vertex that this one was joined to in the end; itself if to none.
  [[nodiscard]] VertexIndex rootOf(VertexIndex vertex) const {
    while (vertexOf_[vertex] != vertex) vertex = vertexOf_[vertex];
    return vertex;
  }
  /// The vertices by place, whatever their order in the mesh.
  [[nodiscard]] const std::vector<VertexIndex>& byPlace() const { return order_; }
  [[nodiscard]] bool isBefore(VertexIndex a, VertexIndex b) const { return ranks_[a] < ranks_[b]; }

  /// Calls visit(triangle, the two corners after the vertex in order) for each triangle around it.
  template <class Visit>
  void forTriangles(VertexIndex vertex, const Visit& visit) const {
    for (std::uint32_t place = first_[vertex]; place != kNone; place = next_[place]) {
      if (corners_[place] != vertex) continue;  // of a removed triangle
      const std::uint32_t turn = place % 3, t = place - turn;
      visit(t, corners_[turn == 2 ? t : place + 1], corners_[turn == 0 ? t + 2 : place - 1]);
    }
  }
  /// Whether the triangles around a vertex do not form a closed fan.
  [[nodiscard]] bool isOnBoundary(VertexIndex vertex) const;
  /// Number of triangles around a vertex.
  [[nodiscard]] std::size_t degree(VertexIndex vertex) const;
  /// Neighbours of a vertex off the boundary, by place.
  void collectNeighbours(VertexIndex vertex, std::vector<VertexIndex>& out) const;

  /// Adds one ring of neighbours to the marks of vertices.
  [[nodiscard]] std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& marks) const;

  /// Joins `drop` to its neighbour `keep` and moves that to `point`. Does not count triangles, as
  /// collapses of edges without a common neighbour may run at the same time.
  void collapse(VertexIndex keep, VertexIndex drop, const Vec3& point);
  /// Subtracts the triangles of so many collapses, two each, from their number.
  void countCollapses(std::size_t count) { alive_ -= 2 * count; }
  /// Flips an edge: the triangles t = (a, b, c) and u = (b, a, d) become (a, d, c) and (b, c, d).
  void turn(std::uint32_t t, std::uint32_t u, VertexIndex a, VertexIndex b, VertexIndex c,
            VertexIndex d);

 private:
  void replaceCorner(std::uint32_t triangle, VertexIndex from, VertexIndex to);

  std::vector<Vec3> points_;
  std::vector<std::uint32_t> ranks_;         // of each vertex by its place
  std::vector<VertexIndex> order_;           // the vertices by rank
  std::vector<VertexIndex> corners_;         // three for each triangle; kNone once it is removed
  std::vector<std::uint32_t> first_, next_;  // the corners at each vertex, as lists
  std::vector<VertexIndex> vertexOf_;        // what a vertex was joined to
  std::size_t alive_ = 0;
};

/// Tests whether edges may be collapsed without changing the topology.
class LinkCheck {
 public:
  /// Whether the topology stays the same: the link condition (Dey, Edelsbrunner, Guha and Nekhayev
  /// 1999) for an edge off the boundary. On a surface it says that the ends have exactly two common
  /// neighbours, those of the two triangles at the edge. These must also keep more than two
  /// triangles. Cost: sorts the neighbours of both ends.
  [[nodiscard]] bool mayCollapse(const EdgeMesh& mesh, VertexIndex a, VertexIndex b);

 private:
  std::vector<VertexIndex> aroundA_, aroundB_;
};

}  // namespace tufa::refine
