#pragma once

#include <array>
#include <vector>

#include "base/vec3.h"
#include "octree/cluster_forest.h"
#include "uniform/surface_view.h"

namespace tufa::distance {

/// The uniform mesh, asked by place: which of its vertices and quads are near a point. Nothing is
/// sorted or searched: cells and crossed edges are bits, and their ranks are the indices.
class UniformReference {
 public:
  UniformReference(const uniform::SurfaceView& base, const octree::ClusterForest& forest,
                   base::Job& job);

  /// An upper bound of the distance from `point` to the base mesh, exact if the nearest vertex has
  /// the nearest polygon: to the polygons around a base vertex in the point's own cell that does
  /// not face away from `facing`; if that is more than `enough`, to those around the nearest such
  /// vertex, then to those around all near ones. Looks `reach` cells far; infinite if there is no
  /// such vertex. World units.
  [[nodiscard]] double distance(const Vec3& point, const Vec3& facing, int reach,
                                double enough) const;
  /// The distance from `point` to one base quad.
  [[nodiscard]] double distanceToQuad(const Vec3& point, std::size_t quad) const;

 private:
  // Ranks of the crossed edges that start in a block: the quads of the block.
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
  // To the polygons around a cell. isKnown(corner, axis) leaves those of an edge of the cell out.
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
