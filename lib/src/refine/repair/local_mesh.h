#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstdint>
#include <vector>

#include "base/bvh.h"
#include "intersect/surface.h"

namespace tufa::refine {

/// A copy of a part of the mesh, to be changed and tested many times. Vertices and polygons have
/// indices of their own here.
class LocalMesh {
 public:
  /// Index of a vertex or polygon of this mesh.
  using Local = VertexIndex;

  /// Takes a copy of these polygons, sorted, and their vertices.
  LocalMesh(const intersect::Surface& surface, std::vector<intersect::PolygonIndex> polygons);

  [[nodiscard]] Local polygonCount() const { return static_cast<Local>(polygons_.size()); }
  [[nodiscard]] Local find(intersect::PolygonIndex polygon) const;
  [[nodiscard]] intersect::PolygonIndex polygonOf(Local polygon) const { return numbers_[polygon]; }
  [[nodiscard]] VertexIndex vertexOf(Local vertex) const { return vertices_[vertex]; }
  /// Whether the vertex is the centre of a fan that was made here.
  [[nodiscard]] bool isNew(Local vertex) const { return vertex >= vertices_.size(); }
  [[nodiscard]] intersect::Corners corners(Local polygon) const {
    return {polygons_[polygon].vertices.data(), counts_[polygon]};
  }
  [[nodiscard]] const Position& point(Local vertex) const { return points_[vertex]; }
  /// The polygons of this mesh at a vertex.
  [[nodiscard]] const std::vector<Local>& around(Local vertex) const { return around_[vertex]; }

  void move(Local vertex, const Position& to);
  /// Flips the diagonal of a quad, by starting it at its next vertex; four times restores it.
  void turn(Local quad);

  /// Whether two polygons, or the triangles of one, intersect elsewhere than in what they share.
  [[nodiscard]] bool meet(Local a, Local b) const {
    return boxes_[a].meets(boxes_[b]) &&
           intersect::intersectElsewhere(points_, corners(a), corners(b), a == b);
  }
  /// Whether the corners of a triangle of the polygon lie on a line.
  [[nodiscard]] bool isFlat(Local polygon) const;

  /// Replaces a quad by four triangles around a new vertex; the first gets the index of the quad,
  /// the others the last ones.
  void fan(Local quad, const Position& centre);
  /// Undoes the last fan.
  void unfan(Local quad, const Quad& was);

 private:
  void updateBox(Local polygon);

  std::vector<VertexIndex> vertices_;  ///< sorted; a fan's centre has none
  std::vector<Position> points_;
  std::vector<std::vector<Local>> around_;
  std::vector<intersect::PolygonIndex> numbers_;  ///< sorted; triangles of a fan have none
  std::vector<Quad> polygons_;
  std::vector<std::uint8_t> counts_;
  std::vector<base::Box> boxes_;
};

}  // namespace tufa::refine
