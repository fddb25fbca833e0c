#pragma once

#include <array>
#include <vector>

#include "base/vec3.h"
#include "octree/cluster_forest.h"
#include "uniform/surface_view.h"

namespace tufa::distance {

/// The uniform mesh as a reference for distances: finds which of its vertices and quads are near a
/// point. Cells and crossed edges are bits of their block, and their ranks are the indices of
/// vertices and quads, so nothing is sorted and no tree is built. Cost: 240 bytes per block; a
/// query reads the bits of a few cells.
class UniformReference {
 public:
  UniformReference(const uniform::SurfaceView& base, const octree::ClusterForest& forest,
                   base::Job& job);

  /// An upper bound on the distance from `point` to the uniform mesh, world units; infinite if no
  /// vertex within `reach` cells faces the right way. Each result is the distance to an existing
  /// polygon.
  ///
  /// Searches in three steps, each only if the one before found nothing within `enough`: the
  /// polygons around a vertex in the cell of the point; those around the nearest vertex; those
  /// around all vertices within two cells. Only vertices whose normals do not face away from
  /// `facing` count, so the far side of a thin wall never does. Exact if the nearest vertex has the
  /// nearest polygon.
  [[nodiscard]] double distance(const Vec3& point, const Vec3& facing, int reach,
                                double enough) const;
  /// The distance from `point` to one uniform quad, world units.
  [[nodiscard]] double distanceToQuad(const Vec3& point, std::size_t quad) const;

 private:
  // The crossed edges that start in a block, by axis and slab, and how many precede each slab. They
  // are the quads of the block in their order.
  struct Edges {
    std::array<std::array<std::uint64_t, 8>, 3> crossed{};
    std::array<std::array<std::uint16_t, 8>, 3> before{};
  };
  struct Near {
    std::uint32_t block = octree::kNone;
    int cell = 0;
    double squared = std::numeric_limits<double>::infinity();
  };

  void searchCell(std::uint32_t block, int cell, const Vec3& point, const Vec3& facing,
                  Near& near) const;
  // The distance to the polygons around a cell. isKnown(corner, axis) tells which edges of the cell
  // to leave out.
  template <class IsKnown>
  [[nodiscard]] double distanceAtCell(std::uint32_t cellBlock, int cellNumber, const Vec3& point,
                                      const IsKnown& isKnown) const;
  [[nodiscard]] double distanceAround(const Vec3& point, const Vec3& facing, double enough) const;
  [[nodiscard]] Near vertexInCell(const Vec3& point, const Vec3& facing) const;
  [[nodiscard]] Near nearestVertex(const Vec3& point, const Vec3& facing, int reach) const;

  const uniform::SurfaceView base_;
  const octree::ClusterForest& forest_;
  std::vector<Edges> edges_;
};

}  // namespace tufa::distance
