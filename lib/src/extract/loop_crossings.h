#pragma once

#include <tufa/mesh.h>

#include <algorithm>
#include <array>

#include "extract/cell_features.h"
#include "extract/cube_cells.h"
#include "grid/affine.h"
#include "uniform/qef.h"

namespace tufa::extraction {

/// Calls body(edge) for the crossings of a loop, in order.
template <class Body>
void forLoop(const CubeCase& cell, int loop, const Body& body) {
  int first = 0;
  while (cell.next[first] < 0 || cell.loopOf[first] != loop) ++first;
  int edge = first;
  do {
    body(edge);
    edge = cell.next[edge];
  } while (edge != first);
}

/// The crossings of one loop of a cell, in order, as placeCrossings() has placed them in a mesh
/// with normals.
class LoopCrossings {
 public:
  /// `place` is that of the cell in the table of its block.
  LoopCrossings(const CubeCase& cell, int loop, int place, const CubeTable& table, const Mesh& mesh)
      : mesh_(mesh) {
    forLoop(cell, loop, [&](int edge) { vertices_[size_++] = table[place + kEdgeOffsets[edge]]; });
  }

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] VertexIndex vertex(int i) const { return vertices_[i]; }
  [[nodiscard]] const Position& position(int i) const { return mesh_.positions[vertices_[i]]; }
  [[nodiscard]] const Normal& normal(int i) const { return mesh_.normals[vertices_[i]]; }

  /// Whether no two of the normals differ by more than an angle of this cosine.
  [[nodiscard]] bool areWithin(double leastCosine) const {
    // Those within half of the angle of the first one are, as angles add up.
    double nearest = 1;
    for (int i = 1; i < size_; ++i) nearest = std::min(nearest, cosine(0, i));
    if (nearest > 0 && 2 * nearest * nearest - 1 >= leastCosine) return true;
    for (int i = 1; i < size_; ++i) {
      for (int k = 0; k < i; ++k) {
        if (cosine(i, k) < leastCosine) return false;
      }
    }
    return true;
  }

  /// The tangent planes, counted from the middle of the cell whose lowest corner is `corner`, in
  /// voxels.
  [[nodiscard]] uniform::Qef planes(const grid::Affine& affine, const Coord& corner) const {
    const auto toVector = [](const Vec3& v) {
      return uniform::Vector{static_cast<float>(v[0]), static_cast<float>(v[1]),
                             static_cast<float>(v[2])};
    };
    uniform::Qef sum;
    for (int i = 0; i < size_; ++i) {
      const Vec3 point = affine.latticePoint(position(i), corner) - Vec3(0.5);
      sum += uniform::Qef(toVector(point), toVector(affine.planeInLattice(normal(i))));
    }
    return sum;
  }

 private:
  [[nodiscard]] double cosine(int i, int k) const {
    const Normal& a = normal(i);
    const Normal& b = normal(k);
    return static_cast<double>(a.x * b.x + a.y * b.y + a.z * b.z);
  }

  const Mesh& mesh_;
  std::array<VertexIndex, kEdges> vertices_{};
  int size_ = 0;
};

/// The vertex of a loop at a point counted from the middle of its cell, with the mean normal of the
/// crossings, or the first one where they cancel out.
inline Feature featureAt(const uniform::Vector& point, const Coord& corner,
                         const LoopCrossings& crossings, const grid::Affine& affine) {
  Vec3 sum(0);
  for (int i = 0; i < crossings.size(); ++i) sum += Vec3(crossings.normal(i));
  if (!sum.normalize()) sum = Vec3(crossings.normal(0));
  return {affine.position(corner, 0.5 + static_cast<double>(point[0]),
                          0.5 + static_cast<double>(point[1]), 0.5 + static_cast<double>(point[2])),
          Normal(sum)};
}

}  // namespace tufa::extraction
