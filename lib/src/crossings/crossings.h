#pragma once

#include <array>

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
  [[nodiscard]] Crossing at(int lower, int axis) const;

  /// Whether a sample is a distance, and not the side of a clamped one.
  [[nodiscard]] bool inBand(float value) const {
    return value > scale_.bandInside && value < scale_.bandOutside;
  }

 private:
  [[nodiscard]] qef::Vector centralDifference(int at) const;
  [[nodiscard]] qef::Vector oneSidedGradient(int at) const;
  [[nodiscard]] bool isKinked(float a, float b, float slopeA, float slopeB, int axis,
                              const qef::Vector& gradient) const;
  [[nodiscard]] float subcellRoot(int lower, int axis) const;

  const blocks::BlockSamples& samples_;
  const blocks::FieldScale& scale_;
};

/// Crossings keep this far from the ends of their edge, so that a sample on the isovalue does not
/// bring the vertices of all cells around it to one point.
inline constexpr float kEndMargin = 1e-3F;

}  // namespace tufa::crossings
