#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/bvh.h"
#include "blocks/isovalue.h"
#include "check/frame.h"
#include "check/trilinear.h"

namespace tufa::checks {

using base::Bvh;

/// Points on the isosurface and a tree over them: what is left to ask where Newton steps fail.
struct PointCloud {
  std::vector<openvdb::Vec3d> points;
  Bvh tree;
};

/// The distance from a point to the trilinear isosurface of a grid, in voxels. For one thread.
template <class GridT>
class SurfaceDistance {
 public:
  SurfaceDistance(TrilinearField<GridT> field, const PointCloud& cloud)
      : field_(std::move(field)), cloud_(cloud) {}

  /// Never less than the true distance: it is the distance to a point found on the surface.
  /// Infinite if the grid has no surface.
  [[nodiscard]] double operator()(const openvdb::Vec3d& from) {
    double distance = std::numeric_limits<double>::infinity();
    if (const auto zero = field_.project(from)) distance = slideCloser(from, *zero);
    // Newton steps may miss a nearer sheet, or find none.
    if (distance > kTrusted) {
      double best = distance * distance;
      const auto squared = [&](std::uint32_t i) { return (cloud_.points[i] - from).lengthSqr(); };
      const std::uint32_t nearest = cloud_.tree.nearest(from, best, squared);
      if (nearest != Bvh::kNone) distance = slideCloser(from, cloud_.points[nearest]);
    }
    return distance;
  }

 private:
  /// Beyond this many voxels Newton's answer is compared with the samples: two sheets of a surface
  /// are seldom nearer to each other than twice this.
  static constexpr double kTrusted = 0.5;

  /// Moves a point of the surface along it towards `from`, while that brings it nearer.
  double slideCloser(const openvdb::Vec3d& from, openvdb::Vec3d zero) {
    double distance = (from - zero).length();
    for (int round = 0; round < 4; ++round) {
      const openvdb::Vec3d away = from - zero;
      const openvdb::Vec3d normal = field_.direction(zero);
      openvdb::Vec3d along = away - normal * normal.dot(away);
      // A slant of 1 in 20 makes the distance 1/800 too long: good enough.
      if (along.length() <= 0.05 * distance) break;
      if (along.length() > 0.5) along *= 0.5 / along.length();
      const auto next = field_.project(zero + along);
      if (!next || (from - *next).length() >= distance) break;
      zero = *next;
      distance = (from - zero).length();
    }
    return distance;
  }

  TrilinearField<GridT> field_;
  const PointCloud& cloud_;
};

}  // namespace tufa::checks
