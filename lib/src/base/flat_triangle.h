#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/vec3.h"

namespace tufa::base {

/// A triangle prepared for many distance queries: most points lie above its inside, where the
/// distance is that to its plane.
class FlatTriangle {
 public:
  FlatTriangle(const Vec3& a, const Vec3& b, const Vec3& c)
      : corners_{a, b, c}, normal_((b - a).cross(c - a)) {
    const double longest2 =
        std::max({(b - a).squaredLength(), (c - b).squaredLength(), (a - c).squaredLength()});
    // Of corners as good as on a line rounding alone would give a normal.
    constexpr double kFlattest = 1e-12;
    if (!normal_.normalize(kFlattest * longest2)) normal_ = Vec3(0);
    for (int i = 0; i < 3; ++i) {
      inward_[i] = normal_.cross(corners_[(i + 1) % 3] - corners_[i]);
    }
  }
  [[nodiscard]] const Vec3& corner(int i) const { return corners_[i]; }
  [[nodiscard]] const Vec3& normal() const { return normal_; }

  /// Whether the point lies above or below the inside of the triangle. If so, `squared` becomes the
  /// squared distance to its plane.
  [[nodiscard]] bool isAbove(const Vec3& point, double& squared) const {
    const Vec3 from = point - corners_[0];
    if (inward_[0].dot(from) < 0 || inward_[1].dot(point - corners_[1]) < 0 ||
        inward_[2].dot(point - corners_[2]) < 0 || normal_.squaredLength() < 0.5) {
      return false;
    }
    const double height = normal_.dot(from);
    squared = height * height;
    return true;
  }
  /// Squared distance of the point.
  [[nodiscard]] double squaredDistance(const Vec3& point) const {
    double squared = 0;
    if (isAbove(point, squared)) return squared;
    // The nearest point lies on an edge that the point is beyond.
    squared = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const Vec3 from = point - corners_[i];
      if (inward_[i].dot(from) > 0) continue;
      const Vec3 side = corners_[(i + 1) % 3] - corners_[i];
      const double length = side.squaredLength();
      const double share = length > 0 ? std::clamp(side.dot(from) / length, 0.0, 1.0) : 0.0;
      squared = std::min(squared, (from - side * share).squaredLength());
    }
    return squared;
  }

 private:
  std::array<Vec3, 3> corners_;
  Vec3 normal_;
  std::array<Vec3, 3> inward_;  ///< across each edge, of any length
};

/// Squared distance of a point to a triangle, for a single query: to the edge, the corner or the
/// inside that is nearest (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
[[nodiscard]] inline double squaredDistanceTo(const Vec3& point, const Vec3& a, const Vec3& b,
                                              const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = point - a, bp = point - b, cp = point - c;
  const auto toSide = [](const Vec3& from, const Vec3& side, double along) {
    const double length = side.squaredLength();
    const double share = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
    return (from - side * share).squaredLength();
  };
  const double abAtA = ab.dot(ap), acAtA = ac.dot(ap), abAtB = ab.dot(bp), acAtB = ac.dot(bp),
               abAtC = ab.dot(cp), acAtC = ac.dot(cp);
  // Barycentric coordinates of the foot of the point, up to a common factor. For a triangle without
  // area they are only rounding errors.
  constexpr double kThin = 1e-12;
  const double ofC = abAtA * acAtB - abAtB * acAtA, ofB = abAtC * acAtA - abAtA * acAtC,
               ofA = abAtB * acAtC - abAtC * acAtB, sum = ofA + ofB + ofC;
  const bool isThin = !(sum > kThin * ab.squaredLength() * ac.squaredLength());
  if (!isThin && ofA > 0 && ofB > 0 && ofC > 0) {
    return (ap - ab * (ofB / sum) - ac * (ofC / sum)).squaredLength();
  }
  // The nearest point lies on an edge that the foot is beyond.
  double squared = std::numeric_limits<double>::infinity();
  if (isThin || ofC <= 0) squared = std::min(squared, toSide(ap, ab, abAtA));
  if (isThin || ofB <= 0) squared = std::min(squared, toSide(ap, ac, acAtA));
  if (isThin || ofA <= 0) {
    const Vec3 bc = c - b;
    squared = std::min(squared, toSide(bp, bc, bc.dot(bp)));
  }
  return squared;
}

}  // namespace tufa::base
