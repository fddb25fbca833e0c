// Unions and intersections, sharp and smooth, and what changes a single field's value.

#include <tufa/implicit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "implicit/boxes.h"
#include "implicit/fields.h"
#include "implicit/interval.h"
#include "implicit/spans.h"

namespace tufa::implicit {
namespace {

/// The lesser of two numbers, rounded off where they differ by less than `radius`: the quadratic
/// polynomial of Quilez. It lies at most radius/4 below both.
double smoothMin(double a, double b, double radius) {
  const double overlap = radius - std::abs(a - b);
  const double least = std::min(a, b);
  return overlap > 0 ? least - overlap * overlap / (4 * radius) : least;
}

/// The share of b's gradient in that of smoothMin(a, b).
double shareOfSecond(double a, double b, double radius) {
  const double overlap = radius - std::abs(a - b);
  const double share = overlap > 0 ? overlap / (2 * radius) : 0;
  return b < a ? 1 - share : share;
}

/// Its range for a range of b - a, in which it falls evenly.
Interval sharesOfSecond(const Interval& difference, double radius) {
  const auto share = [&](double apart) { return std::clamp(0.5 - apart / (2 * radius), 0.0, 1.0); };
  constexpr double kRoom = 1e-15;
  return {std::max(share(difference.greatest) - kRoom, 0.0),
          std::min(share(difference.least) + kRoom, 1.0)};
}

/// Both boxes of vectors in shares, corner by corner.
Box mixed(const Box& a, const Box& b, double share) {
  std::array<Interval, 3> sides;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // 0 times an infinite end would be no number.
    const Interval one = share < 1 ? (1 - share) * sideOf(a, axis) : Interval{0, 0};
    const Interval other = share > 0 ? share * sideOf(b, axis) : Interval{0, 0};
    sides[axis] = one + other;
  }
  return boxOf(sides);
}

/// A union; an intersection is the complement of the complements' union. `sign` is -1 for that one.
class Combination final : public Field {
 public:
  Combination(std::vector<FieldPtr> parts, double radius, double sign)
      : parts_(std::move(parts)), radius_(radius), sign_(sign) {}

  [[nodiscard]] double value(const Position& p) const override {
    double all = kInfinity;
    for (const FieldPtr& part : parts_) all = join(all, sign_ * part->value(p));
    return sign_ * all;
  }

  [[nodiscard]] Position gradient(const Position& p) const override {
    if (radius_ == 0) return parts_[nearest(p)]->gradient(p);
    double all = kInfinity;
    Vec3 slope(0.0);
    for (const FieldPtr& part : parts_) {
      const double next = sign_ * part->value(p);
      const double share = all < kInfinity ? shareOfSecond(all, next, radius_) : 1;
      if (share > 0) slope = slope * (1 - share) + Vec3(part->gradient(p)) * share;
      all = join(all, next);
    }
    return slope;
  }

  [[nodiscard]] Interval bound(const Box& box) const override {
    Interval all{kInfinity, kInfinity};
    for (const FieldPtr& part : parts_) all = join(all, signedBound(*part, box));
    return sign_ > 0 ? all : -all;
  }

  // Blending takes weighted means of gradients, never more than the longest.
  [[nodiscard]] double lipschitz(const Box& box) const override {
    double most = 0;
    for (const FieldPtr& part : parts_) most = std::max(most, part->lipschitz(box));
    return most;
  }

  // Of all that may count: those of a sharp union that may be the least somewhere.
  [[nodiscard]] Box gradientBound(const Box& box) const override {
    if (radius_ > 0) return blendedGradients(box);
    double leastGreatest = kInfinity;
    std::vector<double> least;
    least.reserve(parts_.size());
    for (const FieldPtr& part : parts_) {
      const Interval bound = signedBound(*part, box);
      least.push_back(bound.least);
      leastGreatest = std::min(leastGreatest, bound.greatest);
    }
    Box all{Vec3(kInfinity), Vec3(-kInfinity)};
    for (std::size_t n = 0; n < parts_.size(); ++n) {
      if (least[n] <= leastGreatest) all = hull(all, parts_[n]->gradientBound(box));
    }
    return all;
  }

  [[nodiscard]] bool hasUnitGradient() const override {
    if (radius_ > 0) return false;
    for (const FieldPtr& part : parts_) {
      if (!part->hasUnitGradient()) return false;
    }
    return true;
  }

  // By the parts' own, so that all are of one scale where they meet.
  [[nodiscard]] double distance(const Position& p, double reach) const override {
    if (radius_ > 0) return Field::distance(p, reach);
    double all = kInfinity;
    for (const FieldPtr& part : parts_) all = std::min(all, sign_ * part->distance(p, reach));
    return sign_ * all;
  }

  [[nodiscard]] Box extent() const override {
    Box box = parts_[0]->extent();
    for (const FieldPtr& part : parts_) {
      box = sign_ > 0 ? hull(box, part->extent()) : both(box, part->extent());
    }
    return sign_ > 0 && radius_ > 0 ? blended(box) : box;
  }

  [[nodiscard]] FieldPtr restricted(const Box& box) const override {
    std::vector<FieldPtr> kept;
    Interval all{kInfinity, kInfinity};
    // Without a radius a part that is nowhere least can be left out whatever its place.
    double leastGreatest = kInfinity;
    std::vector<Interval> bounds;
    bounds.reserve(parts_.size());
    for (const FieldPtr& part : parts_) {
      bounds.push_back(signedBound(*part, box));
      leastGreatest = std::min(leastGreatest, bounds.back().greatest);
    }
    bool changed = false;
    for (std::size_t n = 0; n < parts_.size(); ++n) {
      if (radius_ == 0 ? bounds[n].least > leastGreatest
                       : bounds[n].least > all.greatest + radius_) {
        changed = true;
        continue;
      }
      if (radius_ > 0 && all.least > bounds[n].greatest + radius_) {
        changed = changed || !kept.empty();
        kept.clear();
        all = {kInfinity, kInfinity};
      }
      all = join(all, bounds[n]);
      const FieldPtr simpler = parts_[n]->restricted(box);
      changed = changed || simpler != nullptr;
      kept.push_back(simpler ? simpler : parts_[n]);
    }
    if (!changed) return nullptr;
    if (kept.size() == 1) return kept[0];
    return std::make_shared<Combination>(std::move(kept), radius_, sign_);
  }

  [[nodiscard]] bool insideAlong(const Line& line, double begin, double end,
                                 std::vector<Interval>& spans) const override {
    if (radius_ > 0) return false;
    const std::size_t first = spans.size();
    for (const FieldPtr& part : parts_) {
      const std::size_t own = spans.size();
      if (!part->insideAlong(line, begin, end, spans)) {
        spans.resize(first);
        return false;
      }
      if (sign_ < 0) complementFrom(spans, own);
    }
    uniteFrom(spans, first);
    if (sign_ < 0) complementFrom(spans, first);
    return true;
  }

 private:
  [[nodiscard]] double join(double a, double b) const {
    return radius_ > 0 ? smoothMin(a, b, radius_) : std::min(a, b);
  }
  // It grows with both arguments.
  [[nodiscard]] Interval join(const Interval& a, const Interval& b) const {
    const Interval c{join(a.least, b.least), join(a.greatest, b.greatest)};
    return radius_ > 0 ? outward(c.least, c.greatest) : c;
  }
  [[nodiscard]] Interval signedBound(const Field& part, const Box& box) const {
    return sign_ > 0 ? part.bound(box) : -part.bound(box);
  }
  /// As gradient(), with ranges of the shares.
  [[nodiscard]] Box blendedGradients(const Box& box) const {
    Interval all = signedBound(*parts_[0], box);
    Box slopes = parts_[0]->gradientBound(box);
    for (std::size_t n = 1; n < parts_.size(); ++n) {
      const Interval next = signedBound(*parts_[n], box);
      const Interval share = sharesOfSecond(next - all, radius_);
      if (share.greatest > 0) {
        const Box own = parts_[n]->gradientBound(box);
        slopes = share.least < 1
                     ? hull(mixed(slopes, own, share.least), mixed(slopes, own, share.greatest))
                     : own;
      }
      all = join(all, next);
    }
    return slopes;
  }
  /// What blending adds lies within a part of the radius of the parts, in their values; how far
  /// away that is, they tell if they are distances. Boxes of parts may have been turned, and their
  /// corners with them: hence the diagonal.
  [[nodiscard]] Box blended(const Box& box) const {
    // Each further part adds at most a quarter of the radius.
    const double reach = radius_ / 4 * static_cast<double>(parts_.size() - 1);
    for (const FieldPtr& part : parts_) {
      if (!part->hasUnitGradient()) return wholeSpace();
    }
    return grown(box, std::numbers::sqrt3 * reach);
  }
  [[nodiscard]] std::size_t nearest(const Position& p) const {
    std::size_t best = 0;
    double least = kInfinity;
    for (std::size_t n = 0; n < parts_.size(); ++n) {
      const double value = sign_ * parts_[n]->value(p);
      if (value < least) {
        least = value;
        best = n;
      }
    }
    return best;
  }

  std::vector<FieldPtr> parts_;
  double radius_;
  double sign_;
};

/// scale * value - shift, with scale 1 or -1.
class Shifted final : public Field {
 public:
  Shifted(FieldPtr part, double scale, double shift)
      : part_(std::move(part)), scale_(scale), shift_(shift) {}

  [[nodiscard]] double value(const Position& p) const override {
    return scale_ * part_->value(p) - shift_;
  }
  [[nodiscard]] Position gradient(const Position& p) const override {
    return Vec3(part_->gradient(p)) * scale_;
  }
  [[nodiscard]] Interval bound(const Box& box) const override {
    const Interval inner = part_->bound(box);
    return (scale_ > 0 ? inner : -inner) - shift_;
  }
  [[nodiscard]] double lipschitz(const Box& box) const override { return part_->lipschitz(box); }
  [[nodiscard]] Box gradientBound(const Box& box) const override {
    const Box inner = part_->gradientBound(box);
    return scale_ > 0 ? inner : Box{-Vec3(inner.greatest), -Vec3(inner.least)};
  }
  [[nodiscard]] bool hasUnitGradient() const override { return part_->hasUnitGradient(); }
  [[nodiscard]] double distance(const Position& p, double reach) const override {
    return shift_ == 0 ? scale_ * part_->distance(p, reach) : Field::distance(p, reach);
  }
  [[nodiscard]] Box extent() const override {
    if (scale_ < 0) return wholeSpace();
    if (shift_ <= 0) return part_->extent();
    return hasUnitGradient() ? grown(part_->extent(), std::numbers::sqrt3 * shift_) : wholeSpace();
  }
  [[nodiscard]] FieldPtr restricted(const Box& box) const override {
    FieldPtr inner = part_->restricted(box);
    return inner ? std::make_shared<Shifted>(std::move(inner), scale_, shift_) : nullptr;
  }
  [[nodiscard]] bool insideAlong(const Line& line, double begin, double end,
                                 std::vector<Interval>& spans) const override {
    const std::size_t first = spans.size();
    if (shift_ != 0 || !part_->insideAlong(line, begin, end, spans)) return false;
    if (scale_ < 0) complementFrom(spans, first);
    return true;
  }

 private:
  FieldPtr part_;
  double scale_;
  double shift_;
};

class Uniform final : public Field {
 public:
  explicit Uniform(double value) : value_(value) {}
  [[nodiscard]] double value(const Position& /*p*/) const override { return value_; }
  [[nodiscard]] Position gradient(const Position& /*p*/) const override { return {0, 0, 0}; }
  [[nodiscard]] Interval bound(const Box& /*box*/) const override { return {value_, value_}; }
  [[nodiscard]] double lipschitz(const Box& /*box*/) const override { return 0; }
  [[nodiscard]] bool insideAlong(const Line& /*line*/, double /*begin*/, double /*end*/,
                                 std::vector<Interval>& spans) const override {
    if (value_ < 0) spans.push_back(everything());
    return true;
  }

 private:
  double value_;
};

}  // namespace

FieldPtr combine(Operation operation, std::vector<FieldPtr> parts, double radius) {
  if (parts.size() == 1) return parts[0];
  return std::make_shared<Combination>(std::move(parts), radius,
                                       operation == Operation::Union ? 1 : -1);
}

FieldPtr makeComplement(FieldPtr part) { return std::make_shared<Shifted>(std::move(part), -1, 0); }

FieldPtr makeUniform(double value) { return std::make_shared<Uniform>(value); }

FieldPtr makeOffset(FieldPtr part, double by) {
  return std::make_shared<Shifted>(std::move(part), 1, by);
}

FieldPtr makeShell(FieldPtr part, double thickness) {
  // Of the two walls, each the complement of the other moved.
  return combine(
      Operation::Intersection,
      {makeOffset(part, thickness / 2), std::make_shared<Shifted>(part, -1, thickness / 2)}, 0);
}

}  // namespace tufa::implicit
