#pragma once

#include <tufa/mesh.h>
#include <cstddef>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "chunks/chain/chunk_chain.h"

namespace tufa::chunks {

/// The normals of the vertices on curves, split at the creases of the first LOD that has them at
/// their places: the same for all LODs, and on both sides of a plane.
class CurveNormals {
 public:
  CurveNormals(const std::vector<ChainLevel>& levels, double creaseAngle, base::Job& job);

  /// Those of a vertex by its number in ChainLevel::curveVertex: one, or several on a crease.
  [[nodiscard]] std::size_t countAt(VertexIndex v) const { return begin_[v + 1] - begin_[v]; }
  [[nodiscard]] const Normal& at(VertexIndex v, std::size_t number) const {
    return normals_[begin_[v] + number];
  }
  /// The number of the one nearest in direction to the normal of a face, of any length.
  [[nodiscard]] std::size_t nearest(VertexIndex v, const Vec3& face) const;

 private:
  std::vector<std::size_t> begin_;  ///< for each number, in `normals_`
  std::vector<Normal> normals_;
};

/// An LOD for graphics cards: each vertex has one normal, so that a point on a crease becomes
/// several.
struct ShadedLevel {
  std::vector<VertexIndex> sources;  ///< for each vertex its place in ChainLevel::positions
  std::vector<Normal> normals;       ///< one for each vertex
  std::vector<Triangle> triangles;   ///< of these vertices, in the LOD's order
  std::vector<Triangle> changed;     ///< the same beside the next LOD; some are gone
};

/// Splits normals where faces differ by more than `creaseAngle` degrees. A triangle beside the next
/// LOD keeps its normals where its corners do not change.
[[nodiscard]] ShadedLevel shade(const ChainLevel& level, const CurveNormals& curves,
                                double creaseAngle, base::Job& job);

}  // namespace tufa::chunks
