#include "extract/trilinear_surface.h"

#include <algorithm>
#include <cmath>

namespace tufa::extraction {

std::optional<TrilinearSurface::Foot> TrilinearSurface::footOf(const Vec3& point, double reach) {
  constexpr double kFirstStep = 1e-6, kLengthen = 1.5;
  constexpr int kHalvings = 24;  // to a ten-millionth of the reach
  const grid::Affine& affine = volume_.affine;
  const Vec3 start = affine.latticePoint(point, affine.origin());
  const Vec3 gradient = field_.gradient(start);
  const double slope = field_.slope(gradient);
  if (!(slope > 0)) return std::nullopt;
  const Vec3 outward(affine.normalOfPlane(gradient));
  const double first = field_.value(start);
  const double voxel = first < 0 ? affine.voxelSize() : -affine.voxelSize();
  const Vec3 step = affine.latticePoint(point + outward * voxel, affine.origin()) - start;
  const auto isBeyond = [&](double along) {
    return (field_.value(start + step * along) < 0) != (first < 0);
  };
  double low = 0, high = std::min(std::max(std::abs(first) / slope, kFirstStep), reach);
  while (!isBeyond(high)) {
    if (high >= reach) return std::nullopt;
    low = high;
    high = std::min(high * kLengthen, reach);
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double half = (low + high) / 2;
    (isBeyond(half) ? high : low) = half;
  }
  const double along = (low + high) / 2;
  return Foot{point + outward * (along * voxel),
              affine.normalOfPlane(field_.gradient(start + step * along)), along, outward};
}

double TrilinearSurface::distanceOf(const Vec3& point, double tolerance) {
  const Vec3 at = volume_.affine.latticePoint(point, volume_.affine.origin());
  const double slope = field_.slope(field_.gradient(at));
  const double value = std::abs(field_.value(at));
  if (value <= tolerance * slope) return slope > 0 ? value / slope : 0;
  const auto foot = footOf(point, kReach);
  return foot ? foot->distance : kReach;
}

}  // namespace tufa::extraction
