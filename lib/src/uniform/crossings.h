#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "grid/field.h"
#include "grid/samples.h"
#include "uniform/qef.h"

namespace tufa::uniform {

/// Whether the field has a kink at a crossing.
enum class Kink : std::uint8_t {
  None,    ///< it is smooth
  Gentle,  ///< a little one, as between the facets of a scan: a crease may be near
  Sharp,   ///< as between sheets more than 45 degrees apart
};

/// Where the surface crosses a lattice edge.
struct Crossing {
  float along = 0;  ///< place on the edge, from 0 at its lower end to 1
  Vector normal{};  ///< outward unit normal in index space
  Kink kink = Kink::None;
};

/// Crossings of some edges along one axis, one array for each number.
struct CrossingBatch {
  static constexpr int kSize = 16;
  std::array<std::uint16_t, kSize> lower;  ///< in: where each edge starts, a BlockSamples index
  std::array<float, kSize> along;
  std::array<std::array<float, kSize>, 3> normals;
  std::array<Kink, kSize> kinks;

  void set(int lane, const Crossing& crossing) {
    along[lane] = crossing.along;
    for (int i = 0; i < 3; ++i) normals[i][lane] = crossing.normal[i];
    kinks[lane] = crossing.kink;
  }
};

/// Finds crossings from the samples of a block.
///
/// Smooth field: linear interpolation for the place, central differences at both ends,
/// interpolated, for the normal. Where a distance field has a kink, both are wrong: the normals of
/// two sheets are blended, and the place is off by up to 0.3 voxel. A kink shows as a gradient
/// whose length is not 1 in a field that bends, or as slopes along the edge that disagree. There
/// the place comes from the straight lines that continue the field from beyond either end (ENO with
/// subcell resolution, Harten 1989), and the normal from the one-sided differences whose length is
/// nearest to 1.
class CrossingFinder {
 public:
  CrossingFinder(const grid::BlockSamples& samples, const grid::FieldScale& scale)
      : samples_(samples), scale_(scale), limits_(limitsOf(scale)) {}

  /// The crossing of the edge along `axis` that starts at BlockSamples index `lower`.
  template <int axis>
  [[nodiscard]] Crossing at(int lower) const {
    constexpr int kStride = grid::BlockSamples::stride(axis);
    const Ends ends = {samples_[lower], samples_[lower + kStride], centralDifference(lower),
                       centralDifference(lower + kStride),
                       squaredBend(lower) + squaredBend(lower + kStride)};
    const Smooth smooth = smoothCrossing<axis>(ends, limits_);
    if (smooth.kinked != 0) return atKink(lower, axis, kinkOf(ends.squaredBend));
    const float rise = ends.b - ends.a;
    return {smooth.along, direction({smooth.x, smooth.y, smooth.z}, axis, rise), Kink::None};
  }

  /// The crossings of all edges of a batch, as at() finds them, but several at a time.
  template <int axis>
  void findAll(CrossingBatch& batch) const {
    EndArrays arrays;
    for (int lane = 0; lane < CrossingBatch::kSize; ++lane) {
      arrays.load<axis>(samples_.data() + batch.lower[lane], lane);
    }
    const Limits limits = limits_;
    std::array<int, CrossingBatch::kSize> kinked;
    std::array<float, CrossingBatch::kSize> scales;
    for (int lane = 0; lane < CrossingBatch::kSize; ++lane) {
      const Smooth smooth = smoothCrossing<axis>(arrays.ends(lane), limits);
      batch.along[lane] = smooth.along;
      batch.normals[0][lane] = smooth.x;
      batch.normals[1][lane] = smooth.y;
      batch.normals[2][lane] = smooth.z;
      scales[lane] = smooth.squared;
      kinked[lane] = smooth.kinked;
    }
    for (int lane = 0; lane < CrossingBatch::kSize; ++lane) {
      scales[lane] = normalizer(scales[lane], arrays.at[1][lane] - arrays.at[0][lane]);
    }
    for (auto& numbers : batch.normals) {
      for (int lane = 0; lane < CrossingBatch::kSize; ++lane) numbers[lane] *= scales[lane];
    }
    batch.kinks.fill(Kink::None);
    for (int lane = 0; lane < CrossingBatch::kSize; ++lane) {
      if (kinked[lane] != 0) {
        const Kink kink = kinkOf(arrays.squaredBend(0, lane) + arrays.squaredBend(1, lane));
        batch.set(lane, atKink(batch.lower[lane], axis, kink));
      } else if (scales[lane] == 0) {
        const float rise = arrays.at[1][lane] - arrays.at[0][lane];
        batch.set(lane, {batch.along[lane], alongEdge(axis, rise), Kink::None});
      }
    }
  }

  /// Whether a sample is a distance, and not clamped to the width of the narrow band.
  [[nodiscard]] bool inBand(float value) const {
    return value > scale_.bandInside && value < scale_.bandOutside;
  }

  /// Where a linear function from a to b, on different sides of zero, is zero; half way if both are
  /// zero. Without a branch, which would keep the loop over a batch from being vectorized.
  static float linearRoot(float a, float b) {
    const float across = a - b;
    const auto flat = static_cast<float>(across == 0);
    return (a + 0.5F * flat) / (across + flat);
  }

  /// Moved away from the ends of its edge, see kEndMargin.
  static float keptOffEnds(float along) {
    const float kept = along < kEndMargin ? kEndMargin : along;
    return kept > 1 - kEndMargin ? 1 - kEndMargin : kept;
  }

 private:
  // A squared gradient length off 1 by more than this is a kink (two normals 16 degrees apart,
  // blended half and half) or a sample beyond the band. Central differences on a sphere of radius 3
  // voxels are off by 0.02.
  static constexpr float kLengthTolerance = 0.03F;
  // A kink also bends the field. Where the second differences at both ends of the edge together are
  // less than this, the field is smooth and only not quite a distance. A curvature radius of seven
  // voxels gives as much.
  static constexpr float kBendTolerance = 0.3F;
  // A kink changes the slope along the edge by more than this from one sample to the next; a
  // curvature radius of five voxels changes it by 0.1.
  static constexpr float kSlopeTolerance = 0.1F;
  // A kink whose second differences are longer than this is sharp. Sheets whose normals differ by
  // 45 degrees give 0.77 at an end on the kink.
  static constexpr float kSharpBend = 0.8F;
  // Crossings keep this far from the ends of their edge, so that a sample on the isovalue does not
  // pull the vertices of all cells around it to one point.
  static constexpr float kEndMargin = 1e-3F;

  // The samples at both ends of an edge and the gradients there.
  struct Ends {
    float a, b;
    Vector gradientA, gradientB;
    float squaredBend;  // of both ends together, see below
  };

  // The crossing if the field is smooth there; `kinked` if it is not. Plain numbers, so that the
  // compiler can work on several at a time.
  struct Smooth {
    float along;
    float x, y, z;  // gradient
    float squared;  // its squared length
    int kinked;
  };

  // What the test for kinks compares with.
  struct Limits {
    std::array<float, 6> metric;
    std::array<float, 3> slope;
    int distance;
  };

  // The samples around the edges of a batch, one array for each place: the ends, and the neighbours
  // below and above each end on each axis.
  struct EndArrays {
    template <class T>
    using Lanes = std::array<T, CrossingBatch::kSize>;
    std::array<Lanes<float>, 2> at;
    std::array<std::array<Lanes<float>, 3>, 2> below, above;

    template <int axis>
    void load(const float* lower, int lane) {
      using Samples = grid::BlockSamples;
      for (int end = 0; end < 2; ++end) {
        const float* here = lower + end * Samples::stride(axis);
        at[end][lane] = here[0];
        for (int i = 0; i < 3; ++i) {
          below[end][i][lane] = here[-Samples::stride(i)];
          above[end][i][lane] = here[Samples::stride(i)];
        }
      }
    }
    [[nodiscard]] Vector gradient(int end, int lane) const {
      return {0.5F * (above[end][0][lane] - below[end][0][lane]),
              0.5F * (above[end][1][lane] - below[end][1][lane]),
              0.5F * (above[end][2][lane] - below[end][2][lane])};
    }
    // The squared length of the second differences at one end.
    [[nodiscard]] float squaredBend(int end, int lane) const {
      float sum = 0;
      for (int i = 0; i < 3; ++i) {
        const float bend = above[end][i][lane] + below[end][i][lane] - 2 * at[end][lane];
        sum += bend * bend;
      }
      return sum;
    }
    [[nodiscard]] Ends ends(int lane) const {
      return {at[0][lane], at[1][lane], gradient(0, lane), gradient(1, lane),
              squaredBend(0, lane) + squaredBend(1, lane)};
    }
  };

  static Limits limitsOf(const grid::FieldScale& scale) {
    Limits limits{scale.metric, {}, scale.distance ? 1 : 0};
    for (int i = 0; i < 3; ++i) {
      limits.slope[i] = kSlopeTolerance * static_cast<float>(scale.axisLength[i]);
    }
    return limits;
  }

  [[nodiscard]] Vector centralDifference(int at) const {
    using Samples = grid::BlockSamples;
    const float* s = samples_.data() + at;
    return {0.5F * (s[Samples::kStrideX] - s[-Samples::kStrideX]),
            0.5F * (s[Samples::kStrideY] - s[-Samples::kStrideY]), 0.5F * (s[1] - s[-1])};
  }

  [[nodiscard]] float squaredBend(int at) const {
    using Samples = grid::BlockSamples;
    float sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int stride = Samples::stride(axis);
      const float bend = samples_[at + stride] + samples_[at - stride] - 2 * samples_[at];
      sum += bend * bend;
    }
    return sum;
  }

  // The factor that normalizes a gradient of this squared length; 0 if it vanishes beside the rise
  // along the edge: values may be of any size.
  static float normalizer(float squared, float rise) {
    return squared > 1e-12F * rise * rise ? 1 / std::sqrt(squared) : 0;
  }

  // The unit vector along g; along the edge if g vanishes.
  static Vector direction(const Vector& g, int axis, float rise) {
    const float scale = normalizer(dot(g, g), rise);
    Vector normal = {g[0] * scale, g[1] * scale, g[2] * scale};
    if (scale == 0) normal = alongEdge(axis, rise);
    return normal;
  }
  static Vector alongEdge(int axis, float rise) {
    Vector normal{};
    normal[axis] = rise > 0 ? 1.0F : -1.0F;
    return normal;
  }

  template <int axis>
  static Smooth smoothCrossing(const Ends& ends, const Limits& limits) {
    const Vector& ga = ends.gradientA;
    const Vector& gb = ends.gradientB;
    const float root = linearRoot(ends.a, ends.b);
    const Vector g = {ga[0] + root * (gb[0] - ga[0]), ga[1] + root * (gb[1] - ga[1]),
                      ga[2] + root * (gb[2] - ga[2])};
    const auto& m = limits.metric;
    const float squared = m[0] * g[0] * g[0] + m[3] * g[1] * g[1] + m[5] * g[2] * g[2] +
                          2 * (m[1] * g[0] * g[1] + m[2] * g[0] * g[2] + m[4] * g[1] * g[2]);
    const float slope = ends.b - ends.a;
    const int offLength = std::abs(squared - 1) > kLengthTolerance;
    const int bent = ends.squaredBend > kBendTolerance * kBendTolerance;
    const int kinked = (offLength & bent) | (std::abs(ga[axis] - slope) > limits.slope[axis]) |
                       (std::abs(gb[axis] - slope) > limits.slope[axis]);
    return {keptOffEnds(root), g[0], g[1], g[2], dot(g, g), kinked & limits.distance};
  }

  static Kink kinkOf(float squaredBend) {
    return squaredBend > kSharpBend * kSharpBend ? Kink::Sharp : Kink::Gentle;
  }
  [[nodiscard]] Crossing atKink(int lower, int axis, Kink kink) const;
  [[nodiscard]] Vector oneSidedGradient(int at) const;
  [[nodiscard]] float subcellRoot(int lower, int axis) const;

  const grid::BlockSamples& samples_;
  const grid::FieldScale& scale_;
  Limits limits_;
};

}  // namespace tufa::uniform
