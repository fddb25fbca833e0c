#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
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
  /// The number of the one nearest to a direction, of any length.
  [[nodiscard]] std::size_t nearest(VertexIndex v, const Vec3& direction) const;

 private:
  std::vector<std::size_t> begin_;  ///< for each number, in `normals_`
  std::vector<Normal> normals_;
};

/// The triangles along the curves of an LOD, by their edges there.
class CurveSides {
 public:
  struct Side {
    std::uint32_t chunk;                 ///< as ChainLevel::chunkOf has it
    Vec3 face;                           ///< the triangle's normal, of length 1
    std::array<VertexIndex, 2> normals;  ///< the number of each end's in CurveNormals
  };

  /// Ends are numbers as in ChainLevel::curveVertex, in the order of the triangle's corners.
  void add(VertexIndex from, VertexIndex to, const Side& side) {
    sides_.emplace(keyOf(from, to), side);
  }
  [[nodiscard]] const Side* find(VertexIndex from, VertexIndex to) const {
    const auto found = sides_.find(keyOf(from, to));
    return found == sides_.end() ? nullptr : &found->second;
  }

 private:
  static std::uint64_t keyOf(VertexIndex from, VertexIndex to) {
    return std::uint64_t{from} << 32 | to;
  }
  std::unordered_map<std::uint64_t, Side> sides_;
};

/// An LOD for graphics cards: each vertex has one normal, so that a point on a crease becomes
/// several.
struct ShadedLevel {
  std::vector<VertexIndex> sources;  ///< for each vertex its place in ChainLevel::positions
  std::vector<Normal> normals;       ///< one for each vertex
  std::vector<Triangle> triangles;   ///< of these vertices, in the LOD's order
  std::vector<Triangle> changed;     ///< the same beside the next LOD; some are gone
  CurveSides sides;                  ///< for the LOD before
};

/// Splits normals where faces differ by more than `creaseAngle` degrees. `beyond` are the sides of
/// the next LOD; none behind the last. Of vertices on curves triangles that meet smoothly, on both
/// sides of a plane, have the same normals: of one LOD those of a smooth group, and beside the next
/// LOD those that this has. Elsewhere a triangle beside the next LOD keeps its normals where its
/// corners do not change.
[[nodiscard]] ShadedLevel shade(const ChainLevel& level, const CurveNormals& curves,
                                double creaseAngle, const CurveSides& beyond, base::Job& job);

}  // namespace tufa::chunks
