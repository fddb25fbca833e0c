#pragma once

#include <array>
#include <utility>
#include <vector>

#include "base/flat_triangle.h"
#include "base/vec3.h"
#include "refine/collapse/edge_mesh.h"

namespace tufa::refine {

/// 1 for an equilateral triangle, 0 for three points on a line.
[[nodiscard]] double roundness(const Vec3& a, const Vec3& b, const Vec3& c);

/// The triangles around an edge, what becomes of them if it is collapsed, and the tests of their
/// shape.
class Ring {
 public:
  /// Collects the triangles around the edge from `a` to `b`, both of which would become `point`,
  /// where the surface faces `facing`, of any length. False if one would turn over or become a
  /// sliver.
  [[nodiscard]] bool collect(const EdgeMesh& mesh, VertexIndex a, VertexIndex b, const Vec3& point,
                             const Vec3& facing);
  /// Whether no triangle would fold back over a neighbour, in the ring or outside, or none more
  /// sharply than one does now.
  [[nodiscard]] bool staysUnfolded(const EdgeMesh& mesh) const;
  /// Whether the squared distance from the point to the ring is at most `enough`.
  [[nodiscard]] bool isNear(const Vec3& point, double enough) const;
  /// The triangle of the ring nearest to the point, and its squared distance. `first` is tried
  /// first, and taken if the point lies above it and within `enough`, squared.
  [[nodiscard]] std::pair<std::size_t, double> nearest(const Vec3& point, std::size_t first,
                                                       double enough) const;

  /// All triangles around the edge as it is.
  [[nodiscard]] const std::vector<std::uint32_t>& star() const { return star_; }
  /// Those that stay, and what they become: their first corner is the new vertex.
  [[nodiscard]] const std::vector<std::uint32_t>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<base::FlatTriangle>& shapes() const { return shapes_; }

  /// The normal of the triangle across the edge from x to y of another one; `own` if it has none.
  [[nodiscard]] static Vec3 normalAcross(const EdgeMesh& mesh, VertexIndex x, VertexIndex y,
                                         const Vec3& own);

 private:
  [[nodiscard]] double sharpest(const EdgeMesh& mesh) const;

  std::vector<std::uint32_t> star_, triangles_;
  std::vector<std::array<VertexIndex, 2>> edges_;  ///< opposite the new vertex
  std::vector<base::FlatTriangle> shapes_;
};

}  // namespace tufa::refine
