#include "fit/blob_field.h"

#include <cmath>
#include <utility>

namespace tufa::fit {

Sum densityOf(const Ball& ball, const Vec3& point) {
  const Vec3 offset = point - ball.centre;
  const double q = offset.squaredLength() / (ball.radius * ball.radius);
  if (!(q < kReach * kReach)) return {};
  const double density = ball.weight * std::exp(-kBlobbiness * q);
  return {density, offset * (-2 * kBlobbiness * density / (ball.radius * ball.radius))};
}

double volumeOf(const Ball& ball) {
  return std::abs(ball.weight) * ball.radius * ball.radius * ball.radius;
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

double BlobField::energyWith(std::size_t index, std::span<const Ball> balls) const {
  double all = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    Sum sum = sums_[i];
    if (index < balls_.size()) sum -= densityOf(balls_[index], samples_[i].point);
    for (const Ball& ball : balls) sum += densityOf(ball, samples_[i].point);
    all += energyOf(samples_[i], sum);
  }
  double volume = volume_ - (index < balls_.size() ? volumeOf(balls_[index]) : 0);
  for (const Ball& ball : balls) volume += volumeOf(ball);
  return all / static_cast<double>(samples_.size()) + shrinkEnergy(volume);
}

void BlobField::replace(std::size_t index, std::span<const Ball> balls) {
  const auto add = [&](const Ball& ball, double sign) {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sum sum = densityOf(ball, samples_[i].point);
      sums_[i].value += sign * sum.value;
      sums_[i].gradient += sum.gradient * sign;
    }
    volume_ += sign * volumeOf(ball);
  };
  std::size_t next = 0;
  if (index < balls_.size()) {
    add(balls_[index], -1);
    balls_[index] = balls[next++];
    add(balls_[index], 1);
  }
  for (; next < balls.size(); ++next) {
    balls_.push_back(balls[next]);
    add(balls[next], 1);
  }
}

void BlobField::sumUp() {
  sums_.assign(samples_.size(), {});
  volume_ = 0;
  for (const Ball& ball : balls_) {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      sums_[i] += densityOf(ball, samples_[i].point);
    }
    volume_ += volumeOf(ball);
  }
}

}  // namespace tufa::fit
