#include "base/small_angles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec3.h"

namespace tufa::base {
namespace {

// The smallest angle lies opposite the shortest edge. The arc tangent keeps its digits near 0.
double smallestAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double opposite[3] = {bc.squaredLength(), ca.squaredLength(), ab.squaredLength()};
  const double cosines[3] = {-ab.dot(ca), -ab.dot(bc), -bc.dot(ca)};
  const auto at = std::min_element(opposite, opposite + 3) - opposite;
  return std::atan2(ab.cross(bc).length(), cosines[at]) * (180 / std::numbers::pi);
}

}  // namespace

void SmallAngles::add(std::span<const Position> positions, std::span<const Triangle> triangles,
                      double asked) {
  for (const Triangle& triangle : triangles) {
    const auto& v = triangle.vertices;
    const double angle =
        smallestAngle(Vec3(positions[v[0]]), Vec3(positions[v[1]]), Vec3(positions[v[2]]));
    smallest = std::min(smallest, angle);
    below += angle < asked ? 1 : 0;
  }
}

}  // namespace tufa::base
