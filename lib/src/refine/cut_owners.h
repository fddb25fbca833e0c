#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/job.h"
#include "base/vec3f.h"
#include "octree/cut_rule.h"
#include "refine/local_frame.h"
#include "uniform/surface_view.h"

namespace tufa::refine {

/// More than any distance, voxels.
inline constexpr float kFarOff = std::numeric_limits<float>::max();

/// Where the vertices of a uniform mesh go in a mesh taken from a cut, and how far they and its
/// faces are. Faces are numbered two a quad, split from its first vertex to its third.
struct CutOwners {
  using Vec3f = base::Vec3f;

  /// `base`, `frame` and `job` must outlive this object.
  CutOwners(const uniform::SurfaceView& base, const LocalFrame& frame, const octree::CutRule& rule,
            base::Job& job);

  [[nodiscard]] float toleranceAt(std::size_t vertex) const {
    return scales.empty() ? tolerance : tolerance * scales[vertex];
  }
  [[nodiscard]] Triangle faceOf(std::size_t face) const {
    const auto& v = base.mesh.quads[face / 2].vertices;
    return face % 2 == 0 ? Triangle{v[0], v[1], v[2]} : Triangle{v[0], v[2], v[3]};
  }
  /// A vertex in the frame. To keep them all would take a dozen bytes a vertex, and be no faster.
  [[nodiscard]] Vec3f pointOf(VertexIndex vertex) const {
    return frame.toLocal(base.mesh.positions[vertex]);
  }
  /// How far a face may be.
  [[nodiscard]] float limitOf(const Triangle& face) const;

  const uniform::SurfaceView base;
  base::Job& job;
  float tolerance;
  int minLevel;               ///< cells up to this level are not split
  std::vector<float> scales;  ///< of the tolerance at each vertex; empty: 1
  const LocalFrame& frame;    ///< of the uniform mesh
  /// For each vertex its owner, twice the uniform quad that its polygon comes from plus its number
  /// in that polygon, and the distance.
  std::vector<std::uint32_t> owner;
  std::vector<float> distance;
  std::vector<float> faceBound;  ///< of each face; kFarOff: too far, or not measured
};

}  // namespace tufa::refine
