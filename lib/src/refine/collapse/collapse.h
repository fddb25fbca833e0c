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

/// A point of the surface that a mesh stands for.
struct Sample {
  Position point;
  Normal normal;          ///< of the surface there
  std::uint32_t polygon;  ///< of the mesh, near the point; quads first
};

/// One collapse.
struct Step {
  VertexIndex keep, drop;  ///< of the input
  Vec3 point;              ///< of both from then on
  float reach;             ///< how far the surface moved as far as was seen, world length
};

/// A mesh with fewer vertices.
struct Collapsed {
  Mesh mesh;
  std::vector<std::uint32_t> sources;  ///< polygon of the input of each polygon, quads first
  std::vector<VertexIndex> vertexOf;   ///< for each vertex of the input
  std::vector<std::uint32_t> members;  ///< number of input vertices of each vertex
  std::vector<VertexIndex> turned;     ///< corners of triangles at an edge that was turned
  double budgetScale = 1;              ///< what `allowed` was multiplied by to get so far
  std::vector<std::uint32_t> sampleTriangles;  ///< for a next collapse
  std::vector<Step> steps;                     ///< in order, for a next collapse
  /// Steps that may be made at the same time: of each phase, one after another, the ends of its
  /// groups in `steps`.
  std::vector<std::vector<std::size_t>> phases;
};

/// What bounds a collapse.
struct Bounds {
  /// None may be farther from the mesh than is allowed there.
  std::vector<Sample> samples;
  /// For each vertex, how far the surface may move there, world length; 0: the vertex stays as it
  /// is.
  std::vector<float> budget;
  /// The distance to the surface from a point of the mesh with a normal; what is less than `enough`
  /// may be more than it is. Asked where samples of several sides are near.
  std::function<double(const Vec3& point, const Vec3& normal, double enough)> distance;
  /// Stop at so many; `allowed` is multiplied by more and more until that is reached or nothing
  /// helps. 0: as few as is allowed.
  std::size_t triangles = 0;
  /// A result for the same mesh, more freedom, and the first of the samples, or null: what it
  /// collapsed is collapsed again where that is still allowed.
  const Collapsed* before = nullptr;
  std::vector<std::uint8_t> rolledBack;  ///< of its steps, those not to be made again; empty: none
  std::vector<std::uint8_t> locked;      ///< vertices that no new steps are made with; empty: none
  bool onlyRepeat = false;               ///< make no new steps
  std::vector<float> turning;            ///< as `allowed`, where edges are turned; empty: none are
  Rim rim;                               ///< which vertices may be joined
  /// Whether a vertex may lie at a point; else the middle of the edge is taken. Null: anywhere.
  std::function<bool(VertexIndex vertex, const Vec3& point)> mayLie;
};

/// Collapses edges of a mesh with normals, the one of least error first, each to the point of least
/// squared distance to the planes of both its vertices (`planes`, each seen from its vertex).
///
/// Keeps the mesh a manifold of the same topology (the link condition; vertices on a boundary
/// stay). A collapse is not made if a triangle around it would turn over or become a needle, if a
/// sample near those triangles would be farther from them than is allowed, or the new vertex from
/// the surface at its nearest sample. Last, edges are turned that make needles, see turnNeedles().
/// Quads of which nothing was changed stay quads.
/// Large meshes are collapsed in regions; the result does not depend on the number of threads.
[[nodiscard]] Collapsed collapse(const Mesh& mesh, const std::vector<base::Quadric>& planes,
                                 const Bounds& bounds, base::Job& job);

}  // namespace tufa::refine
