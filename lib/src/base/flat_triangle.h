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
  /// Squared distance of the point to the triangle's plane, not more than to the triangle; 0
  /// without a plane.
  [[nodiscard]] double squaredHeight(const openvdb::Vec3d& point) const {
    const double height = normal_.dot(point - corners_[0]);
    return height * height;
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

/// Squared distance of a point to a triangle that is asked one question: to the side, the corner or
/// the inside that the point is nearest to (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
[[nodiscard]] inline double squaredDistanceTo(const openvdb::Vec3d& point, const openvdb::Vec3d& a,
                                              const openvdb::Vec3d& b, const openvdb::Vec3d& c) {
  const openvdb::Vec3d ab = b - a, ac = c - a, ap = point - a, bp = point - b, cp = point - c;
  const auto toSide = [](const openvdb::Vec3d& from, const openvdb::Vec3d& side, double along) {
    const double length = side.lengthSqr();
    const double share = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
    return (from - side * share).lengthSqr();
  };
  const double abAtA = ab.dot(ap), acAtA = ac.dot(ap), abAtB = ab.dot(bp), acAtB = ac.dot(bp),
               abAtC = ab.dot(cp), acAtC = ac.dot(cp);
  // Shares of the corners a, b and c in the foot of the point, times one area. Those of a triangle
  // without an area are but rounding.
  constexpr double kThin = 1e-12;
  const double ofC = abAtA * acAtB - abAtB * acAtA, ofB = abAtC * acAtA - abAtA * acAtC,
               ofA = abAtB * acAtC - abAtC * acAtB, sum = ofA + ofB + ofC;
  const bool isThin = !(sum > kThin * ab.lengthSqr() * ac.lengthSqr());
  if (!isThin && ofA > 0 && ofB > 0 && ofC > 0) {
    return (ap - ab * (ofB / sum) - ac * (ofC / sum)).lengthSqr();
  }
  // The nearest point lies on a side that the foot is beyond.
  double squared = std::numeric_limits<double>::infinity();
  if (isThin || ofC <= 0) squared = std::min(squared, toSide(ap, ab, abAtA));
  if (isThin || ofB <= 0) squared = std::min(squared, toSide(ap, ac, acAtA));
  if (isThin || ofA <= 0) {
    const openvdb::Vec3d bc = c - b;
    squared = std::min(squared, toSide(bp, bc, bc.dot(bp)));
  }
  return squared;
}

}  // namespace tufa::base
