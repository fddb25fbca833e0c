#pragma once

#include <tufa/mesh.h>

#include <cstdint>
#include <span>

namespace tufa::base {

/// Index of a polygon of a mesh: quads come first, then triangles.
using PolygonIndex = std::uint32_t;

/// The vertices of a polygon in order.
using Corners = std::span<const VertexIndex>;

[[nodiscard]] inline Corners cornersOf(const Mesh& mesh, PolygonIndex polygon) {
  if (polygon < mesh.quads.size()) return mesh.quads[polygon].vertices;
  return mesh.triangles[polygon - mesh.quads.size()].vertices;
}

/// Calls body(polygon, corners) for each polygon.
template <class Body>
void forPolygons(const Mesh& mesh, const Body& body) {
  const auto count = static_cast<PolygonIndex>(mesh.quads.size() + mesh.triangles.size());
  for (PolygonIndex polygon = 0; polygon < count; ++polygon)
    body(polygon, cornersOf(mesh, polygon));
}

/// Calls body(vertex) for each corner of each polygon, which may change it.
template <class Body>
void forCorners(Mesh& mesh, const Body& body) {
  for (Quad& quad : mesh.quads) {
    for (VertexIndex& vertex : quad.vertices) body(vertex);
  }
  for (Triangle& triangle : mesh.triangles) {
    for (VertexIndex& vertex : triangle.vertices) body(vertex);
  }
}

}  // namespace tufa::base
