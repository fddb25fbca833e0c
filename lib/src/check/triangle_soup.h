#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <vector>

#include "base/bvh.h"
#include "base/job.h"
#include "base/vec3.h"
#include "grid/voxel_frame.h"

namespace tufa::checks {

using base::Box;
using base::Bvh;

/// The valid triangles of a mesh in voxel space, and the nearest of them to any point.
class TriangleSoup {
 public:
  TriangleSoup(const Mesh& mesh, const grid::VoxelFrame& frame, base::Job& job);

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  [[nodiscard]] const Vec3& point(VertexIndex v) const { return points_[v]; }

  /// The vertices that triangles have, in their order.
  [[nodiscard]] std::vector<VertexIndex> usedVertices() const;

  /// The distance to the nearest triangle; infinite if there is none. `hint` is a triangle that is
  /// likely near, or Bvh::kNone, and becomes the nearest: queries in spatial order are then much
  /// faster.
  [[nodiscard]] double distance(const Vec3& from, std::uint32_t& hint) const;

 private:
  [[nodiscard]] double distanceSquared(const Vec3& from, std::uint32_t triangle) const;
  [[nodiscard]] std::vector<Box> boxes(base::Job& job) const;

  std::vector<Vec3> points_;  ///< one for each position of the mesh
  std::vector<Triangle> triangles_;
  Bvh tree_;
};

}  // namespace tufa::checks
