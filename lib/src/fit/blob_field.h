#pragma once

#include <tufa/fit.h>

#include <span>
#include <vector>

#include "base/vec3.h"

namespace tufa::fit {

/// Of all fits.
inline constexpr double kThreshold = 0.5;
inline constexpr double kBlobbiness = 4;
/// In radii: farther out a density counts as 0, here and in makeMetaballs().
inline constexpr double kReach = 2.276;

/// A blob where the mesh's diagonal is 1 and its box's centre is the origin.
struct UnitBlob {
  Vec3 centre{0.0};
  double radius = 1;
  double weight = 1;
};

/// A point of the mesh, in the same frame.
struct Sample {
  Vec3 point;
  Vec3 normal;
};

struct Weights {
  double value, normal, shrink;
};

/// The densities' sum at a sample, and its gradient.
struct Sum {
  double value = 0;
  Vec3 gradient{0.0};

  Sum& operator+=(const Sum& other) {
    value += other.value, gradient += other.gradient;
    return *this;
  }
  Sum& operator-=(const Sum& other) {
    value -= other.value, gradient -= other.gradient;
    return *this;
  }
};

/// What a blob adds at a point.
[[nodiscard]] Sum densityOf(const UnitBlob& blob, const Vec3& point);

/// A blob's part of the term that makes them small.
[[nodiscard]] double volumeOf(const UnitBlob& blob);

/// Blobs and what they sum up to at the samples.
class BlobField {
 public:
  BlobField(std::vector<Sample> samples, const Weights& weights);

  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  [[nodiscard]] const std::vector<Sum>& sums() const { return sums_; }
  [[nodiscard]] const std::vector<UnitBlob>& blobs() const { return blobs_; }
  [[nodiscard]] const Weights& weights() const { return weights_; }
  [[nodiscard]] double volume() const { return volume_; }

  /// The sum of the three terms.
  [[nodiscard]] double energy() const;
  /// The energy if one blob, `index`, or none if that is the number of blobs, were replaced with
  /// some.
  [[nodiscard]] double energyWith(std::size_t index, std::span<const UnitBlob> blobs) const;
  /// Replaces it, the first of them in its place, the others at the end.
  void replace(std::size_t index, std::span<const UnitBlob> blobs);
  /// Sums up anew, so that rounding does not gather.
  void sumUp();

 private:
  [[nodiscard]] double energyOf(const Sample& sample, const Sum& sum) const;
  [[nodiscard]] double shrinkEnergy(double volume) const;

  std::vector<Sample> samples_;
  Weights weights_;
  std::vector<UnitBlob> blobs_;
  std::vector<Sum> sums_;
  double volume_ = 0;
};

}  // namespace tufa::fit
