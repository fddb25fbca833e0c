#include "uniform/crossings.h"

#include <limits>

namespace tufa::uniform {

using grid::BlockSamples;

Crossing CrossingFinder::atKink(int lower, int axis, Kink kink) const {
  const int stride = BlockSamples::stride(axis);
  Crossing crossing;
  crossing.kink = kink;
  crossing.along = keptOffEnds(subcellRoot(lower, axis));
  const Vector g = oneSidedGradient(crossing.along < 0.5F ? lower : lower + stride);
  const float rise = samples_[lower + stride] - samples_[lower];
  crossing.normal = direction(g, axis, rise);
  return crossing;
}

// Picks a forward or backward difference on each axis so that the gradient's length is nearest to
// 1: beside a kink, differences across it give a gradient that is shorter or longer. Samples beyond
// the band are not used. Cost: eight combinations.
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

// The root of the field along the edge, taken as two straight lines that go on from beyond either
// end (Harten 1989). They meet at the kink; the root counts if it is on the line's own side of
// that. Otherwise the kink is not on this edge, and linear interpolation is as good.
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

}  // namespace tufa::uniform
