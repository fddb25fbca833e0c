#include "advise/feature_size.h"

#include <algorithm>
#include <cmath>

namespace tufa::advise {
namespace {

// Voxels between two samples of a line: sheets thinner than that may be missed, but those that the
// signs of samples show are hardly ever.
constexpr double kStep = 0.25;
// The points that lines begin at are off the trilinear surface by less, in voxels.
constexpr double kOff = 1;
// The share of its distance that a field is trusted to hold.
constexpr double kTrusted = 0.8;
// Of lines to another side of the same feature: that of a cube's diagonal is 0.58. Beside an edge a
// line may leave through the other face, which it grazes.
constexpr double kLeastCosine = 0.5;
// Shorter means of unit normals tell no direction.
constexpr double kLeastMean = 0.2;

}  // namespace

double FeatureSize::at(const Vec3& point, Vec3 outward) {
  if (!outward.normalize(kLeastMean)) return reach_;
  const grid::Affine& affine = volume_.affine;
  const Coord& origin = affine.origin();
  const Vec3 start = affine.latticePoint(point, origin);
  const Vec3 step = affine.latticePoint(point + outward * affine.voxelSize(), origin) - start;
  return std::min(alongLine(start, -step, true), alongLine(start, step, false));
}

double FeatureSize::alongLine(const Vec3& start, const Vec3& step, bool intoSolid) {
  bool entered = false;
  double before = 0, valueBefore = 0;
  for (double along = kStep; along < reach_;) {
    const double here = field_.value(start + step * along);
    const bool isThere = (here < 0) == intoSolid;
    if (entered && !isThere) {
      const double length = before + (along - before) * valueBefore / (valueBefore - here);
      const double cosine = cosineAt(start + step * length, step);
      return cosine < kLeastCosine ? reach_ : length * cosine;
    }
    if (!entered && !isThere && along >= kOff) {
      return cosineAt(start, step) < kLeastCosine ? reach_ : kStep;
    }
    entered = entered || isThere;
    before = along;
    valueBefore = here;
    along += volume_.scale.distance ? std::max(kStep, kTrusted * std::abs(here)) : kStep;
  }
  return reach_;
}

double FeatureSize::cosineAt(const Vec3& point, const Vec3& step) {
  const Vec3 gradient = field_.gradient(point);
  const double slope = field_.slope(gradient);
  return slope > 0 ? std::abs(gradient.dot(step)) / slope : 1;
}

}  // namespace tufa::advise
