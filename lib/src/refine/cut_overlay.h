#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/polygons.h"
#include "octree/cut.h"
#include "octree/cut_polygons.h"
#include "reduce/corners.h"
#include "reduce/overlay_path.h"
#include "refine/cut_owners.h"
#include "refine/cut_triangles.h"

namespace tufa::refine {

/// The faces of a uniform mesh over the triangles of a mesh taken from a cut, as
/// reduce/overlay_path.h overlays them.
class CutOverlay {
 public:
  CutOverlay(const CutOwners& owners, const octree::Cut& cut, const octree::CutMesh& made);

  /// The polygon that a triangle is of, given as an owner; kNone if it is not there any more.
  [[nodiscard]] base::PolygonIndex polygonOf(std::uint32_t id) const { return polygonOf_[id / 2]; }
  /// The corners of a triangle; none if it is not there any more.
  [[nodiscard]] base::Corners cornersOf(std::uint32_t id, Triangle& storage) const;
  /// Whether a vertex of the uniform mesh is one of the mesh.
  [[nodiscard]] bool isFine(VertexIndex r) const {
    return cut_.clusters[cut_.vertexOf[r]].level == 0;
  }
  /// Whether a face is a triangle of the mesh.
  [[nodiscard]] bool isInMesh(std::uint32_t face, const Triangle& r) const;

  /// Collects the triangles that ways over the faces at some vertices may lead over. What follows
  /// is about these.
  void collectTriangles(const std::vector<std::uint8_t>& isCorner);
  [[nodiscard]] const CutTriangles& triangles() const { return triangles_; }
  [[nodiscard]] const reduce::CornersOfVertices& corners() const { return *corners_; }

  [[nodiscard]] reduce::OwnedFace ownedFace(const Triangle& r) const;
  /// A bound of the squared distance of a face that has owners; more than the square of the limit
  /// if there is none within. onTurn: as for reduce::overlayBound2().
  template <class OnTurn>
  [[nodiscard]] float bound2(const reduce::OwnedFace& face, float limit,
                             const OnTurn& onTurn) const {
    const auto way = [&](std::size_t a, std::size_t b, reduce::OverlayPath& path) {
      return findWay(face, a, b, limit * limit, path);
    };
    return reduce::overlayBound2(triangles_, face, limit * limit, way, onTurn);
  }
  /// The same, without turns.
  [[nodiscard]] float bound2(const reduce::OwnedFace& face, float limit) const;

 private:
  [[nodiscard]] reduce::Index localOf(std::uint32_t id) const {
    return firstLocal_[polygonOf_[id / 2]] + id % 2;
  }
  [[nodiscard]] float acrossOneEdge2(const reduce::OwnedFace& face) const;
  bool findWay(const reduce::OwnedFace& face, std::size_t a, std::size_t b, float limit2,
               reduce::OverlayPath& way) const;
  void addMarked(const std::vector<std::uint8_t>& marks);

  const CutOwners& owners_;
  const octree::Cut& cut_;
  const octree::CutMesh& made_;
  const Mesh& mesh_;
  std::vector<base::PolygonIndex> polygonOf_;  // of each uniform quad; kNone for none
  CutTriangles triangles_;
  std::optional<reduce::CornersOfVertices> corners_;
  std::vector<reduce::Index> firstLocal_;  // of each polygon that is there, in triangles_
};

/// Calls body(i) for each index below `count`, in parallel.
template <class Body>
void forEach(base::Job& job, std::size_t count, const Body& body) {
  job.forRanges(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Marks from several threads at a time.
inline void mark(std::vector<std::uint8_t>& marks, std::size_t at) {
  std::atomic_ref<std::uint8_t>(marks[at]).store(1, std::memory_order_relaxed);
}

/// Marks the vertices that share a polygon with something marked.
[[nodiscard]] std::vector<std::uint8_t> grown(const Mesh& mesh,
                                              const std::vector<std::uint8_t>& marks,
                                              base::Job& job);

}  // namespace tufa::refine
