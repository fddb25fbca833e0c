#include "fit/blob_field.h"

#include <cmath>
#include <utility>

namespace tufa::fit {

Sum densityOf(const UnitBlob& blob, const Vec3& point) {
  const Vec3 offset = point - blob.centre;
  const double q = offset.squaredLength() / (blob.radius * blob.radius);
  if (!(q < kReach * kReach)) return {};
  const double density = blob.weight * std::exp(-kBlobbiness * q);
  return {density, offset * (-2 * kBlobbiness * density / (blob.radius * blob.radius))};
}

double volumeOf(const UnitBlob& blob) {
  return std::abs(blob.weight) * blob.radius * blob.radius * blob.radius;
}

BlobField::BlobField(std::vector<Sample> samples, const Weights& weights)
    : samples_(std::move(samples)), weights_(weights), sums_(samples_.size()) {}

double BlobField::energyOf(const Sample& sample, const Sum& sum) const {
  const double off = sum.value - kThreshold;
  const double length = sum.gradient.length();
  // Where the field is level there is no normal.
  const Vec3 turn = length > 0 ? sample.normal + sum.gradient / length : sample.normal;
  return weights_.value * off * off + weights_.normal * turn.squaredLength();
}

double BlobField::shrinkEnergy(double volume) const { return weights_.shrink * volume * volume; }

double BlobField::energy() const {
  double all = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) all += energyOf(samples_[i], sums_[i]);
  return all / static_cast<double>(samples_.size()) + shrinkEnergy(volume_);
}

double BlobField::energyWith(std::size_t index, std::span<const UnitBlob> blobs) const {
  double all = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    Sum sum = sums_[i];
    if (index < blobs_.size()) sum -= densityOf(blobs_[index], samples_[i].point);
    for (const UnitBlob& blob : blobs) sum += densityOf(blob, samples_[i].point);
    all += energyOf(samples_[i], sum);
  }
  double volume = volume_ - (index < blobs_.size() ? volumeOf(blobs_[index]) : 0);
  for (const UnitBlob& blob : blobs) volume += volumeOf(blob);
  return all / static_cast<double>(samples_.size()) + shrinkEnergy(volume);
}

void BlobField::replace(std::size_t index, std::span<const UnitBlob> blobs) {
  const auto add = [&](const UnitBlob& blob, double sign) {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sum sum = densityOf(blob, samples_[i].point);
      sums_[i].value += sign * sum.value;
      sums_[i].gradient += sum.gradient * sign;
    }
    volume_ += sign * volumeOf(blob);
  };
  std::size_t next = 0;
  if (index < blobs_.size()) {
    add(blobs_[index], -1);
    blobs_[index] = blobs[next++];
    add(blobs_[index], 1);
  }
  for (; next < blobs.size(); ++next) {
    blobs_.push_back(blobs[next]);
    add(blobs[next], 1);
  }
}

void BlobField::sumUp() {
  sums_.assign(samples_.size(), {});
  volume_ = 0;
  for (const UnitBlob& blob : blobs_) {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      sums_[i] += densityOf(blob, samples_[i].point);
    }
    volume_ += volumeOf(blob);
  }
}

}  // namespace tufa::fit
