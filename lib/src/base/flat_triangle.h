#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tufa::base {

/// A triangle taken apart for many distance questions: most points lie above its inside, where the
/// distance is the one to its plane.
class FlatTriangle {
 public:
  FlatTriangle(const openvdb::Vec3d& a, const openvdb::Vec3d& b, const openvdb::Vec3d& c)
      : corners_{a, b, c}, normal_((b - a).cross(c - a)) {
    if (!normal_.normalize()) normal_ = openvdb::Vec3d(0);
    for (int i = 0; i < 3; ++i) {
      inward_[i] = normal_.cross(corners_[(i + 1) % 3] - corners_[i]);
    }
  }
  [[nodiscard]] const openvdb::Vec3d& corner(int i) const { return corners_[i]; }
  [[nodiscard]] const openvdb::Vec3d& normal() const { return normal_; }

  /// Whether the point lies above or below the inside of the triangle. If so, `squared` becomes the
  /// squared distance to its plane.
  [[nodiscard]] bool isAbove(const openvdb::Vec3d& point, double& squared) const {
    const openvdb::Vec3d from = point - corners_[0];
    if (inward_[0].dot(from) < 0 || inward_[1].dot(point - corners_[1]) < 0 ||
        inward_[2].dot(point - corners_[2]) < 0 || normal_.lengthSqr() < 0.5) {
      return false;
    }
    const double height = normal_.dot(from);
    squared = height * height;
    return true;
  }
  /// Squared distance of the point.
  [[nodiscard]] double squaredDistance(const openvdb::Vec3d& point) const {
    double squared = 0;
    if (isAbove(point, squared)) return squared;
    // The nearest point lies on a side that the point is beyond.
    squared = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const openvdb::Vec3d from = point - corners_[i];
      if (inward_[i].dot(from) > 0) continue;
      const openvdb::Vec3d side = corners_[(i + 1) % 3] - corners_[i];
      const double length = side.lengthSqr();
      const double share = length > 0 ? std::clamp(side.dot(from) / length, 0.0, 1.0) : 0.0;
      squared = std::min(squared, (from - side * share).lengthSqr());
    }
    return squared;
  }

 private:
  std::array<openvdb::Vec3d, 3> corners_;
  openvdb::Vec3d normal_;
  std::array<openvdb::Vec3d, 3> inward_;  ///< across each side, of any length
};

}  // namespace tufa::base
