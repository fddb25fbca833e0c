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

double mix(double a, double b, double t) { return a + (b - a) * t; }

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
    const double here = value(start + step * along);
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

void FeatureSize::load(const Coord& cell) {
  if (isLoaded_ && cell == cell_) return;
  isLoaded_ = true;
  cell_ = cell;
  const grid::FieldScale& scale = volume_.scale;
  for (int n = 0; n < 8; ++n) {
    const double raw =
        accessor_->value((cell + volume_.affine.origin()).offsetBy(n >> 2, (n >> 1) & 1, n & 1));
    corners_[n] = std::isfinite(raw) ? (raw - scale.isovalue) * scale.factor : 1;
  }
}

double FeatureSize::value(const Vec3& point) {
  load(floorCoord(point));
  const double x = point[0] - cell_[0], y = point[1] - cell_[1], z = point[2] - cell_[2];
  const double* v = corners_;
  return mix(mix(mix(v[0], v[1], z), mix(v[2], v[3], z), y),
             mix(mix(v[4], v[5], z), mix(v[6], v[7], z), y), x);
}

double FeatureSize::cosineAt(const Vec3& point, const Vec3& step) {
  load(floorCoord(point));
  const double x = point[0] - cell_[0], y = point[1] - cell_[1], z = point[2] - cell_[2];
  const double* v = corners_;
  const Vec3 gradient(mix(mix(v[4] - v[0], v[5] - v[1], z), mix(v[6] - v[2], v[7] - v[3], z), y),
                      mix(mix(v[2] - v[0], v[3] - v[1], z), mix(v[6] - v[4], v[7] - v[5], z), x),
                      mix(mix(v[1] - v[0], v[3] - v[2], y), mix(v[5] - v[4], v[7] - v[6], y), x));
  const auto single = [&](int axis) { return static_cast<float>(gradient[axis]); };
  const double length =
      std::sqrt(static_cast<double>(volume_.scale.squaredLength(single(0), single(1), single(2))));
  return length > 0 ? std::abs(gradient.dot(step)) / length : 1;
}

}  // namespace tufa::advise
