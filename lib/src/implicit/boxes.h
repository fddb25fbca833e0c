#pragma once

#include <tufa/implicit.h>

#include <algorithm>
#include <array>

#include "base/vec3.h"
#include "implicit/interval.h"

namespace tufa::implicit {

[[nodiscard]] inline Interval sideOf(const Box& box, std::size_t axis) {
  return {Vec3(box.least)[axis], Vec3(box.greatest)[axis]};
}
[[nodiscard]] inline Vec3 centreOf(const Box& box) {
  return (Vec3(box.least) + Vec3(box.greatest)) * 0.5;
}
/// From the centre to a corner.
[[nodiscard]] inline Vec3 halfOf(const Box& box) {
  return (Vec3(box.greatest) - Vec3(box.least)) * 0.5;
}
[[nodiscard]] inline Box boxAround(const Vec3& centre, const Vec3& half) {
  return {centre - half, centre + half};
}
[[nodiscard]] inline Box wholeSpace() { return {Vec3(-kInfinity), Vec3(kInfinity)}; }
[[nodiscard]] inline bool isFinite(const Box& box) {
  return Vec3(box.least).isFinite() && Vec3(box.greatest).isFinite();
}
[[nodiscard]] inline Box hull(const Box& a, const Box& b) {
  return {minVec3(a.least, b.least), maxVec3(a.greatest, b.greatest)};
}
/// What lies in both; a box without inside, at a point, if nothing does.
[[nodiscard]] inline Box both(const Box& a, const Box& b) {
  const Vec3 least = maxVec3(a.least, b.least);
  return {least, maxVec3(least, minVec3(a.greatest, b.greatest))};
}
[[nodiscard]] inline Box grown(const Box& box, double by) {
  return {Vec3(box.least) - Vec3(by), Vec3(box.greatest) + Vec3(by)};
}

/// A box of three intervals.
[[nodiscard]] inline Box boxOf(const std::array<Interval, 3>& sides) {
  return {Vec3(sides[0].least, sides[1].least, sides[2].least),
          Vec3(sides[0].greatest, sides[1].greatest, sides[2].greatest)};
}
/// Scalar products of the vectors in a box with a vector.
[[nodiscard]] inline Interval dot(const Vec3& a, const Box& vectors) {
  return a[0] * sideOf(vectors, 0) + a[1] * sideOf(vectors, 1) + a[2] * sideOf(vectors, 2);
}

/// Bounds over a box of a function with that value in its centre that changes by at most
/// `lipschitz` a unit.
[[nodiscard]] inline Interval aroundCentre(double value, double lipschitz, const Box& box) {
  // The value may be rounded by more than its own size: by that of what it is a difference of.
  const double room = 1e-14 * (std::abs(value) + centreOf(box).length());
  const double reach = lipschitz * halfOf(box).length() + room;
  return reach < kInfinity ? outward(value - reach, value + reach) : everything();
}

}  // namespace tufa::implicit
