#include "crossings/crossings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tufa::crossings {

using blocks::BlockSamples;
using qef::Vector;

namespace {

// A squared gradient length off 1 by more than this is a kink (two normals 16 degrees apart, blended
// half and half) or a sample beyond the band. Central differences on a sphere of radius 3 voxels are
// off by 0.02.
constexpr float kLengthTolerance = 0.03F;
// Slopes along an edge that differ by more than this from one sample to the next: a curvature radius
// of five voxels gives 0.1.
constexpr float kSlopeTolerance = 0.1F;

// Where a linear change from a to b is zero, half way if neither says.
float linearRoot(float a, float b) { return a == b ? 0.5F : a / (a - b); }

}  // namespace

Vector CrossingFinder::centralDifference(int at) const {
  const float* s = samples_.data() + at;
  return {0.5F * (s[BlockSamples::kStrideX] - s[-BlockSamples::kStrideX]),
          0.5F * (s[BlockSamples::kStrideY] - s[-BlockSamples::kStrideY]), 0.5F * (s[1] - s[-1])};
}

bool CrossingFinder::isKinked(float a, float b, float slopeA, float slopeB, int axis,
                              const Vector& g) const {
  const float squared = scale_.squaredLength(g[0], g[1], g[2]);
  const float tolerance = kSlopeTolerance * static_cast<float>(scale_.axisLength[axis]);
  return std::abs(squared - 1) > kLengthTolerance || std::abs(slopeA - (b - a)) > tolerance ||
         std::abs(slopeB - (b - a)) > tolerance;
}

Crossing CrossingFinder::at(int lower, int axis) const {
  const int stride = BlockSamples::stride(axis);
  const float a = samples_[lower], b = samples_[lower + stride];
  const Vector ga = centralDifference(lower), gb = centralDifference(lower + stride);
  Crossing crossing;
  crossing.along = linearRoot(a, b);
  Vector g;
  for (int i = 0; i < 3; ++i) g[i] = ga[i] + crossing.along * (gb[i] - ga[i]);
  if (scale_.distance && isKinked(a, b, ga[axis], gb[axis], axis, g)) {
    crossing.crease = true;
    crossing.along = subcellRoot(lower, axis);
    g = oneSidedGradient(crossing.along < 0.5F ? lower : lower + stride);
  }
  crossing.along = std::clamp(crossing.along, kEndMargin, 1 - kEndMargin);
  const float squared = qef::dot(g, g);
  if (squared > 1e-12F) {
    const float scale = 1 / std::sqrt(squared);
    crossing.normal = {g[0] * scale, g[1] * scale, g[2] * scale};
  } else {
    crossing.normal[axis] = b > a ? 1.0F : -1.0F;
  }
  return crossing;
}

// Of the forward and backward differences on each axis, those whose gradient has a length nearest to
// 1; samples beyond the band do not take part.
Vector CrossingFinder::oneSidedGradient(int at) const {
  const float here = samples_[at];
  std::array<std::array<float, 2>, 3> sides{};
  std::array<int, 3> count{};
  for (int axis = 0; axis < 3; ++axis) {
    const int stride = BlockSamples::stride(axis);
    for (const int step : {-stride, stride}) {
      const float there = samples_[at + step];
      if (!inBand(there)) continue;
      sides[axis][count[axis]++] = step > 0 ? there - here : here - there;
    }
    if (count[axis] == 0) {
      sides[axis][count[axis]++] = 0.5F * (samples_[at + stride] - samples_[at - stride]);
    }
  }
  Vector best{};
  float bestError = std::numeric_limits<float>::infinity();
  for (int choice = 0; choice < 8; ++choice) {
    const std::array<int, 3> pick = {choice >> 2, (choice >> 1) & 1, choice & 1};
    Vector g;
    bool there = true;
    for (int axis = 0; axis < 3; ++axis) {
      there &= pick[axis] < count[axis];
      g[axis] = sides[axis][pick[axis]];
    }
    if (!there) continue;
    const float error = std::abs(scale_.squaredLength(g[0], g[1], g[2]) - 1);
    if (error < bestError) {
      bestError = error;
      best = g;
    }
  }
  return best;
}

// The field along the edge as two straight lines, one from each end by the slope beyond it.
float CrossingFinder::subcellRoot(int lower, int axis) const {
  const int stride = BlockSamples::stride(axis);
  const float a = samples_[lower], b = samples_[lower + stride];
  const float before = samples_[lower - stride], after = samples_[lower + 2 * stride];
  const float linear = linearRoot(a, b);
  if (!inBand(before) || !inBand(after)) return linear;
  const float slopeA = a - before, slopeB = after - b;
  const float meet = (b - slopeB - a) / (slopeA - slopeB);
  if (!(meet > 0 && meet < 1)) return linear;
  const float rootA = -a / slopeA, rootB = 1 - b / slopeB;
  if (rootA >= 0 && rootA <= meet) return rootA;
  if (rootB >= meet && rootB <= 1) return rootB;
  return linear;
}

}  // namespace tufa::crossings
