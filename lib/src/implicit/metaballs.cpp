#include "implicit/metaballs.h"

#include <cmath>
#include <memory>
#include <utility>

#include "base/bvh.h"
#include "base/job.h"
#include "implicit/boxes.h"
#include "implicit/interval.h"

namespace tufa::implicit {
namespace {

/// A kernel as a function of q = s².
struct Kernel {
  static constexpr double kLeast = 1e-9;  ///< of Blinn's: all below it is 0
  BallKernel kind;
  double blobbiness;

  /// Where it ends: in radii.
  [[nodiscard]] double reach() const {
    return kind == BallKernel::Blinn ? std::sqrt(-std::log(kLeast) / blobbiness) : 1;
  }
  /// What it falls to 0 from, there.
  [[nodiscard]] double last() const { return kind == BallKernel::Blinn ? kLeast * 1.000001 : 0; }
  [[nodiscard]] double density(double q) const {
    switch (kind) {
      case BallKernel::Blinn:
        return std::exp(-blobbiness * q);
      case BallKernel::Nishimura:
        return q < 1.0 / 9 ? 1 - 3 * q : 1.5 * square(1 - std::sqrt(q));
      case BallKernel::Wyvill:
        break;
    }
    return 1 + q * (-22.0 / 9 + q * (17.0 / 9 - q * (4.0 / 9)));
  }
  /// By q.
  [[nodiscard]] double slope(double q) const {
    switch (kind) {
      case BallKernel::Blinn:
        return -blobbiness * std::exp(-blobbiness * q);
      case BallKernel::Nishimura:
        return q < 1.0 / 9 ? -3 : -1.5 * (1 - std::sqrt(q)) / std::sqrt(q);
      case BallKernel::Wyvill:
        break;
    }
    return -22.0 / 9 + q * (34.0 / 9 - q * (12.0 / 9));
  }
  /// Those by q over a range of s: each kernel's grows from its centre to its end.
  [[nodiscard]] Interval slopes(const Interval& s) const {
    const double least = std::max(s.least, 0.0);
    const double most = s.greatest < reach() ? slope(square(s.greatest)) : 0;
    return outward(slope(square(least)), most);
  }
  /// Where its slope by s is steepest: it grows up to there and falls behind.
  [[nodiscard]] double steepest() const {
    switch (kind) {
      case BallKernel::Blinn:
        return std::sqrt(0.5 / blobbiness);
      case BallKernel::Nishimura:
        return 1.0 / 3;
      case BallKernel::Wyvill:
        break;
    }
    // The lesser root of the second derivative, 60 s⁴ - 102 s² + 22.
    return std::sqrt((102 - std::sqrt(102.0 * 102 - 4 * 60 * 22)) / 120);
  }
  /// The length of the greatest slope by s from one distance to another.
  [[nodiscard]] double steepestIn(double least, double greatest) const {
    const double s = std::clamp(steepest(), least, greatest);
    return 2 * s * std::abs(slope(s * s)) * (1 + 1e-9);
  }
};

/// How near and how far a box comes to a point.
Interval distancesTo(const Vec3& point, const Box& box) {
  double near = 0;
  double far = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Interval side = sideOf(box, axis);
    near += square(std::max({side.least - point[axis], point[axis] - side.greatest, 0.0}));
    far += square(std::max(point[axis] - side.least, side.greatest - point[axis]));
  }
  return outward(std::sqrt(near), std::sqrt(far));
}

class Metaballs final : public Field {
 public:
  Metaballs(std::vector<Metaball> balls, const Kernel& kernel, double threshold)
      : balls_(std::move(balls)), kernel_(kernel), threshold_(threshold) {}

  /// A tree over the balls, so that only those that reach a point are asked.
  void index() {
    constexpr std::size_t kFew = 16;
    if (balls_.size() <= kFew) return;
    std::vector<base::Box> boxes;
    boxes.reserve(balls_.size());
    for (const Metaball& ball : balls_) {
      const Vec3 half(reachOf(ball) * (1 + 1e-12));
      boxes.push_back({ball.centre - half, ball.centre + half});
    }
    base::Job job(0, {});
    job.run([&] { tree_ = std::make_unique<base::Bvh>(std::move(boxes), job); });
  }

  [[nodiscard]] double value(const Position& p) const override {
    double sum = 0;
    forNear({p, p}, [&](const Metaball& ball) {
      const double q = (Vec3(p) - ball.centre).squaredLength() / square(ball.radius);
      if (q < square(kernel_.reach())) sum += ball.weight * kernel_.density(q);
    });
    return threshold_ - sum;
  }

  [[nodiscard]] Position gradient(const Position& p) const override {
    Vec3 slope(0.0);
    forNear({p, p}, [&](const Metaball& ball) {
      const Vec3 offset = Vec3(p) - ball.centre;
      const double q = offset.squaredLength() / square(ball.radius);
      if (!(q < square(kernel_.reach()))) return;
      slope -= offset * (2 * ball.weight * kernel_.slope(q) / square(ball.radius));
    });
    return slope;
  }

  [[nodiscard]] Interval bound(const Box& box) const override {
    Interval sum{0, 0};
    double steepest = 0;
    double steps = 0;
    forNear(box, [&](const Metaball& ball) {
      const Interval s = distancesTo(ball.centre, box) / ball.radius;
      if (s.least >= kernel_.reach()) return;
      const double far =
          s.greatest >= kernel_.reach() ? 0 : kernel_.density(square(s.greatest)) * (1 - 1e-12);
      const double near = kernel_.density(square(std::max(s.least, 0.0))) * (1 + 1e-12);
      sum = sum + ball.weight * Interval{far, near};
      steepest += steepnessOf(ball, s);
      // Blinn's kernel does not quite end at 0.
      if (s.greatest >= kernel_.reach()) steps += std::abs(ball.weight) * kernel_.last();
    });
    return both(threshold_ - sum,
                aroundCentre(value(centreOf(box)), steepest, box) + Interval{-steps, steps});
  }

  [[nodiscard]] double lipschitz(const Box& box) const override {
    double steepest = 0;
    forNear(box, [&](const Metaball& ball) {
      steepest += steepnessOf(ball, distancesTo(ball.centre, box) / ball.radius);
    });
    return steepest;
  }

  [[nodiscard]] Box gradientBound(const Box& box) const override {
    std::array<Interval, 3> sum{};
    forNear(box, [&](const Metaball& ball) {
      const Interval s = distancesTo(ball.centre, box) / ball.radius;
      if (s.least >= kernel_.reach()) return;
      const Interval factor = kernel_.slopes(s) * (-2 * ball.weight / (ball.radius * ball.radius));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        sum[axis] = sum[axis] + factor * (sideOf(box, axis) - ball.centre[axis]);
      }
    });
    return boxOf(sum);
  }

  [[nodiscard]] Box extent() const override {
    Box all = boxAround(balls_[0].centre, Vec3(0.0));
    for (const Metaball& ball : balls_) {
      if (ball.weight > 0) all = hull(all, boxAround(ball.centre, Vec3(reachOf(ball))));
    }
    return all;
  }

  // In the order of the tree, so that sums are the same to the last bit.
  [[nodiscard]] FieldPtr restricted(const Box& box) const override {
    std::vector<Metaball> near;
    forNear(box, [&](const Metaball& ball) {
      if (distancesTo(ball.centre, box).least < reachOf(ball)) near.push_back(ball);
    });
    if (near.size() == balls_.size() && !tree_) return nullptr;
    return std::make_shared<Metaballs>(std::move(near), kernel_, threshold_);
  }

 private:
  [[nodiscard]] double reachOf(const Metaball& ball) const { return ball.radius * kernel_.reach(); }
  [[nodiscard]] double steepnessOf(const Metaball& ball, const Interval& s) const {
    const double least = std::max(s.least, 0.0);
    const double greatest = std::min(s.greatest, kernel_.reach());
    if (least >= greatest) return 0;
    return std::abs(ball.weight) / ball.radius * kernel_.steepestIn(least, greatest);
  }

  template <class Visit>
  void forNear(const Box& box, const Visit& visit) const {
    if (!tree_) {
      for (const Metaball& ball : balls_) visit(ball);
      return;
    }
    tree_->itemsMeeting({box.least, box.greatest},
                        [&](std::uint32_t n, const base::Box& /*box*/) { visit(balls_[n]); });
  }

  std::vector<Metaball> balls_;
  Kernel kernel_;
  double threshold_;
  std::unique_ptr<base::Bvh> tree_;
};

}  // namespace

FieldPtr makeMetaballs(std::vector<Metaball> balls, const MetaballOptions& options) {
  auto field = std::make_shared<Metaballs>(
      std::move(balls), Kernel{options.kernel, options.blobbiness}, options.threshold);
  field->index();
  return field;
}

}  // namespace tufa::implicit
