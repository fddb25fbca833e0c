#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "refine/collapse/least_point.h"
#include "refine/collapse/rim.h"

namespace tufa::refine {

/// A point of the surface that a mesh stands for, to which the mesh must stay near.
struct Sample {
  Position point;
  Normal normal;          ///< of the surface there
  std::uint32_t polygon;  ///< of the mesh, near the point; quads first
};

/// One collapse.
struct Step {
  VertexIndex keep, drop;  ///< of the input
  Vec3 point;              ///< of both from then on
  float reach;             ///< largest distance found when it was tested, world length
};

/// A mesh with fewer vertices.
struct Collapsed {
  Mesh mesh;
  std::vector<std::uint32_t> sources;  ///< polygon of the input of each polygon, quads first
  std::vector<VertexIndex> vertexOf;   ///< for each vertex of the input
  std::vector<std::uint32_t> members;  ///< number of input vertices of each vertex
  std::vector<VertexIndex> turned;     ///< corners of triangles at a flipped edge
  double budgetScale = 1;              ///< what Bounds::budget was multiplied by in the end
  std::vector<std::uint32_t> sampleTriangles;  ///< for a next collapse
  std::vector<Step> steps;                     ///< in order, for a next collapse
  /// The phases that the steps were made in: for each, the ends of its groups in `steps`. Groups of
  /// one phase are independent and may be repeated in parallel.
  std::vector<std::vector<std::size_t>> phases;
};

/// What bounds a collapse.
struct Bounds {
  /// None may be farther from the mesh than the error budget there.
  std::vector<Sample> samples;
  /// Error budget of each vertex: how far the surface may move there, world length. 0: the vertex
  /// stays as it is.
  std::vector<float> budget;
  /// The distance to the surface from a point of the mesh with a normal. Exact above `enough`; a
  /// result below that may be too large. Called where samples of several sheets are near.
  std::function<double(const Vec3& point, const Vec3& normal, double enough)> distance;
  /// Stop at so many triangles; the error budgets are scaled up until that is reached or nothing
  /// helps. 0: as few as the budgets allow.
  std::size_t triangles = 0;
  /// An earlier result for the same mesh, with budgets no smaller and with the first of the
  /// samples, or null: its collapses are repeated where they are still allowed.
  const Collapsed* before = nullptr;
  std::vector<std::uint8_t> rolledBack;  ///< of its steps, those not to be made again; empty: none
  std::vector<std::uint8_t> locked;      ///< vertices that no new steps are made with; empty: none
  bool onlyRepeat = false;               ///< make no new steps
  std::vector<float> turning;            ///< error budgets for edge flips; empty: none
  Rim rim;                               ///< which vertices may be joined
  /// Whether a vertex may lie at a point; else the edge's middle is taken. Null: anywhere.
  std::function<bool(VertexIndex vertex, const Vec3& point)> mayLie;
};

/// Collapses edges of a mesh with normals, by rising error, each to the point of least squared
/// distance to the planes of all that its ends stand for (Garland and Heckbert 1997). `planes` has
/// those of each vertex, in coordinates counted from it.
///
/// Keeps the mesh a manifold of the same topology (the link condition; vertices on a boundary
/// stay). A collapse is refused if a triangle around it would turn over, fold back over a neighbour
/// or become a sliver; if a sample near those triangles would be farther from them than the error
/// budget; or if the new vertex would be farther from the surface, as its nearest sample tells.
/// Last, long edges of slivers are flipped, see flipSlivers(). Quads of which nothing changed stay
/// quads.
///
/// Distances are bounded at samples, not between them: the caller measures. Large meshes are
/// collapsed in the parts of a partition, in parallel; the result does not depend on the number of
/// threads. Cost: the same for each edge tried, whatever the size of the mesh: the queue takes
/// constant time, and only the star of the edge and the samples on it are read.
[[nodiscard]] Collapsed collapse(const Mesh& mesh, const std::vector<base::Quadric>& planes,
                                 const Bounds& bounds, base::Job& job);

}  // namespace tufa::refine
