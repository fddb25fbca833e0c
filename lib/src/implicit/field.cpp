#include <tufa/implicit.h>

#include "implicit/boxes.h"

namespace tufa::implicit {
namespace {

/// The distance to the first change of sign along a line, in steps that double, then halve. For
/// fields that are steep, or flat, beside the surface.
double searched(const Field& field, const Vec3& from, const Vec3& outward, double here,
                double reach) {
  const Vec3 towards = outward * (here < 0 ? 1 : -1);
  const auto changed = [&](double at) {
    return (field.value(from + towards * at) < 0) != (here < 0);
  };
  constexpr double kFirst = 1.0 / 16;
  constexpr int kHalvings = 12;
  double near = 0;
  double far = reach * kFirst;
  while (!changed(far)) {
    if (far >= reach) return std::copysign(reach, here);
    near = far;
    far = std::min(2 * far, reach);
  }
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = (near + far) / 2;
    (changed(middle) ? far : near) = middle;
  }
  return std::copysign((near + far) / 2, here);
}

}  // namespace

Field::Field() = default;
Field::~Field() = default;

Box Field::gradientBound(const Box& box) const {
  const double most = lipschitz(box);
  return {Vec3(-most), Vec3(most)};
}

bool Field::hasUnitGradient() const { return false; }

double Field::distance(const Position& point, double reach) const {
  const double here = value(point);
  if (hasUnitGradient() || here == 0) return here;
  const Vec3 slope = gradient(point);
  const double first = here / slope.length();
  if (!(std::abs(first) < kInfinity)) return std::copysign(reach, here);
  const double steepness = slope.length();
  const Vec3 outward = slope / steepness;
  // A step of Newton's method further, from where the surface seems to be: what it takes away is
  // the error of the first, to second order, where the slope is about the same in both places.
  const Position foot = Vec3(point) - outward * first;
  const double there = Vec3(gradient(foot)).length();
  const double second = value(foot) / there;
  if (std::abs(second) < std::abs(first) / 2 && there < 2 * steepness && steepness < 2 * there) {
    return first + second;
  }
  if (!(reach < kInfinity)) return first;
  return searched(*this, point, outward, here, reach);
}

Box Field::extent() const { return wholeSpace(); }

std::shared_ptr<const Field> Field::restricted(const Box& /*box*/) const { return nullptr; }

bool Field::insideAlong(const Line& /*line*/, double /*begin*/, double /*end*/,
                        std::vector<Interval>& /*spans*/) const {
  return false;
}

Position Field::normal(const Position& point) const {
  Vec3 along = gradient(point);
  // The longest component first: squares of very short or long ones would vanish or overflow.
  const double longest = std::max({std::abs(along[0]), std::abs(along[1]), std::abs(along[2])});
  if (!(longest > 0 && longest < kInfinity)) return {0, 0, 0};
  along /= longest;
  return along / along.length();
}

}  // namespace tufa::implicit
