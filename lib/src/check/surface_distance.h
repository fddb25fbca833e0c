#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "base/bvh.h"
#include "base/vec3.h"
#include "grid/isosurface.h"
#include "grid/isovalue.h"
#include "grid/voxel_frame.h"

namespace tufa::checks {

using base::Bvh;

/// Points on the isosurface and a tree over them: the fallback where Newton steps fail.
struct PointCloud {
  std::vector<Vec3> points;
  Bvh tree;
};

/// The distance from a point to the trilinear isosurface of a grid, in voxels. For one thread.
class SurfaceDistance {
 public:
  SurfaceDistance(std::unique_ptr<grid::TrilinearField> field, const PointCloud& cloud)
      : field_(std::move(field)), cloud_(cloud) {}

  /// Never less than the true distance: it is the distance to a point found on the surface.
  /// Infinite if the grid has no surface.
  [[nodiscard]] double operator()(const Vec3& from) {
    double distance = std::numeric_limits<double>::infinity();
    if (const auto zero = field_->project(from)) distance = slideCloser(from, *zero);
    // Newton steps may miss a nearer sheet, or find none.
    if (distance > kTrusted) {
      double best = distance * distance;
      const auto squared = [&](std::uint32_t i) {
        return (cloud_.points[i] - from).squaredLength();
      };
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
  double slideCloser(const Vec3& from, Vec3 zero) {
    double distance = (from - zero).length();
    for (int round = 0; round < 4; ++round) {
      const Vec3 away = from - zero;
      const Vec3 normal = field_->direction(zero);
      Vec3 along = away - normal * normal.dot(away);
      // A slant of 1 in 20 makes the distance 1/800 too long, which is accurate enough.
      if (along.length() <= 0.05 * distance) break;
      if (along.length() > 0.5) along *= 0.5 / along.length();
      const auto next = field_->project(zero + along);
      if (!next || (from - *next).length() >= distance) break;
      zero = *next;
      distance = (from - zero).length();
    }
    return distance;
  }

  std::unique_ptr<grid::TrilinearField> field_;
  const PointCloud& cloud_;
};

}  // namespace tufa::checks
