#include <openvdb/math/Mat3.h>

#include <algorithm>
#include <cmath>

#include "shapes/fields.h"

namespace tufa::shapes {
namespace {

constexpr double kHalfX = 0.9;
constexpr double kHalfY = 0.7;
constexpr double kHalfZ = 0.5;

/// The rotation about a fixed axis, as the matrix that Rodrigues' formula gives.
const openvdb::Mat3d& shapeRotation() {
  static const openvdb::Mat3d rotation = [] {
    const Vec3 axis = Vec3(0.36, -0.71, 0.53).unit();
    const double angle = 0.83;
    return openvdb::math::rotation<openvdb::Mat3d>(axis, angle);
  }();
  return rotation;
}

class Box final : public DistanceField {
 public:
  [[nodiscard]] double halfExtent() const override {
    return std::sqrt(kHalfX * kHalfX + kHalfY * kHalfY + kHalfZ * kHalfZ);
  }

  [[nodiscard]] double distance(const Vec3& point) const override {
    const Vec3 p = toShapeFrame(point);
    const Vec3 beyond(std::abs(p.x()) - kHalfX, std::abs(p.y()) - kHalfY, std::abs(p.z()) - kHalfZ);
    const double inside = std::max({beyond.x(), beyond.y(), beyond.z()});
    if (inside <= 0) return inside;
    return Vec3(std::max(beyond.x(), 0.0), std::max(beyond.y(), 0.0), std::max(beyond.z(), 0.0))
        .length();
  }
};

}  // namespace

Vec3 toShapeFrame(const Vec3& worldPoint) { return shapeRotation() * worldPoint; }

Vec3 toWorldFrame(const Vec3& shapePoint) { return shapeRotation().transpose() * shapePoint; }

void appendSegment(const Vec3& a, const Vec3& b, double spacing, std::vector<Position>& points) {
  const int steps = std::max(1, static_cast<int>(std::ceil((b - a).length() / spacing)));
  for (int n = 0; n <= steps; ++n) {
    const double t = static_cast<double>(n) / steps;
    const Vec3 p = toWorldFrame(a * (1 - t) + b * t);
    points.emplace_back(p.x(), p.y(), p.z());
  }
}

std::unique_ptr<DistanceField> makeBox() { return std::make_unique<Box>(); }

std::vector<Position> boxCreasePoints(double spacing) {
  std::vector<Position> points;
  const Vec3 half(kHalfX, kHalfY, kHalfZ);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 4; ++side) {
      Vec3 a = half;
      if (side & 1) a[(axis + 1) % 3] *= -1;
      if (side & 2) a[(axis + 2) % 3] *= -1;
      Vec3 b = a;
      b[axis] *= -1;
      appendSegment(a, b, spacing, points);
    }
  }
  return points;
}

}  // namespace tufa::shapes
