#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "blocks/field.h"
#include "blocks/samples.h"
#include "qef/qef.h"

namespace tufa::crossings {

/// Where the surface crosses a lattice edge.
struct Crossing {
  float along = 0;        ///< place on the edge, from 0 at its lower end to 1
  qef::Vector normal{};   ///< outward unit normal in index space
  bool crease = false;    ///< the field has a kink here: a crease may be near
};

/// Finds crossings from the samples of a block.
///
/// Smooth field: linear interpolation for the place, central differences at both ends, interpolated,
/// for the normal. Where a distance field has a kink, both are wrong: the normals of two sides are
/// blended, and the place is off by up to 0.3 voxel. A kink shows as a gradient whose length is not 1
/// or as slopes along the edge that disagree. There the place comes from the straight lines on either
/// side (ENO with subcell resolution, Harten 1989), and the normal from the one-sided differences
/// whose length is nearest to 1.
class CrossingFinder {
 public:
  CrossingFinder(const blocks::BlockSamples& samples, const blocks::FieldScale& scale)
      : samples_(samples), scale_(scale) {}

  /// The crossing of the edge along `axis` that starts at BlockSamples index `lower`.
  template <int axis>
  [[nodiscard]] Crossing at(int lower) const {
    constexpr int kStride = blocks::BlockSamples::stride(axis);
    const float a = samples_[lower], b = samples_[lower + kStride];
    const qef::Vector ga = centralDifference(lower), gb = centralDifference(lower + kStride);
    Crossing crossing;
    crossing.along = linearRoot(a, b);
    qef::Vector g;
    for (int i = 0; i < 3; ++i) g[i] = ga[i] + crossing.along * (gb[i] - ga[i]);
    if (scale_.distance && isKinked(b - a, ga[axis], gb[axis], axis, g)) return atKink(lower, axis);
    finish(crossing, g, axis, b > a);
    return crossing;
  }

  /// Whether a sample is a distance, and not the side of a clamped one.
  [[nodiscard]] bool inBand(float value) const {
    return value > scale_.bandInside && value < scale_.bandOutside;
  }

 private:
  // A squared gradient length off 1 by more than this is a kink (two normals 16 degrees apart,
  // blended half and half) or a sample beyond the band. Central differences on a sphere of radius 3
  // voxels are off by 0.02.
  static constexpr float kLengthTolerance = 0.03F;
  // Slopes along an edge that differ by more than this from one sample to the next: a curvature
  // radius of five voxels gives 0.1.
  static constexpr float kSlopeTolerance = 0.1F;
  // Crossings keep this far from the ends of their edge, so that a sample on the isovalue does not
  // bring the vertices of all cells around it to one point.
  static constexpr float kEndMargin = 1e-3F;

  // Where a linear change from a to b is zero, half way if neither says.
  static float linearRoot(float a, float b) { return a == b ? 0.5F : a / (a - b); }

  [[nodiscard]] qef::Vector centralDifference(int at) const {
    using Samples = blocks::BlockSamples;
    const float* s = samples_.data() + at;
    return {0.5F * (s[Samples::kStrideX] - s[-Samples::kStrideX]),
            0.5F * (s[Samples::kStrideY] - s[-Samples::kStrideY]), 0.5F * (s[1] - s[-1])};
  }

  [[nodiscard]] bool isKinked(float slope, float slopeA, float slopeB, int axis,
                              const qef::Vector& g) const {
    const float tolerance = kSlopeTolerance * static_cast<float>(scale_.axisLength[axis]);
    return std::abs(scale_.squaredLength(g[0], g[1], g[2]) - 1) > kLengthTolerance ||
           std::abs(slopeA - slope) > tolerance || std::abs(slopeB - slope) > tolerance;
  }

  // Keeps the crossing off the ends of its edge and gives it the direction of `g`; along the edge if
  // the gradient vanishes.
  static void finish(Crossing& crossing, const qef::Vector& g, int axis, bool rising) {
    crossing.along = std::clamp(crossing.along, kEndMargin, 1 - kEndMargin);
    const float squared = qef::dot(g, g);
    if (squared > 1e-12F) {
      const float scale = 1 / std::sqrt(squared);
      crossing.normal = {g[0] * scale, g[1] * scale, g[2] * scale};
    } else {
      crossing.normal[axis] = rising ? 1.0F : -1.0F;
    }
  }

  [[nodiscard]] Crossing atKink(int lower, int axis) const;
  [[nodiscard]] qef::Vector oneSidedGradient(int at) const;
  [[nodiscard]] float subcellRoot(int lower, int axis) const;

  const blocks::BlockSamples& samples_;
  const blocks::FieldScale& scale_;
};

}  // namespace tufa::crossings
