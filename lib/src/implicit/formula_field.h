#pragma once

#include <tufa/implicit.h>

#include <cmath>
#include <memory>
#include <utility>

#include "implicit/boxes.h"
#include "implicit/dual.h"
#include "implicit/interval.h"

namespace tufa::implicit {

/// The coordinates of a point as numbers that know their derivatives.
template <class T>
std::array<Dual<T>, 3> variables(const T& x, const T& y, const T& z, const T& one) {
  const T zero{};
  return {{{x, {one, zero, zero}}, {y, {zero, one, zero}}, {z, {zero, zero, one}}}};
}

/// A field that is one formula. `Formula` has
/// * `operator()(x, y, z)`, a template, for numbers, intervals and duals of both;
/// * `extent()`, a box that holds the inside;
/// * `kUnitGradient`: whether it is a distance;
/// * perhaps `mayLackValues(x, y, z)` of intervals: whether it may be NaN for some of their
/// numbers,
///   of which operator() bounds the values only;
/// * perhaps `insideAlong(from, direction, spans)`, as Field::insideAlong().
template <class Formula>
class FormulaField final : public Field {
 public:
  explicit FormulaField(Formula formula) : formula_(std::move(formula)) {}

  /// Points where the formula has no value are outside.
  [[nodiscard]] double value(const Position& p) const override {
    const double value = formula_(p.x, p.y, p.z);
    return std::isnan(value) ? kInfinity : value;
  }

  [[nodiscard]] Position gradient(const Position& p) const override {
    return toPosition(dualAt(p).slopes);
  }

  [[nodiscard]] Interval bound(const Box& box) const override {
    if constexpr (Formula::kUnitGradient) {
      const Interval natural = formula_(sideOf(box, 0), sideOf(box, 1), sideOf(box, 2));
      return both(natural, aroundCentre(value(centreOf(box)), 1, box));
    } else {
      // The mean value form beside the natural one (Moore 1966): better where the box is small.
      const Dual<Interval> over = overBox(box);
      if (mayLackValues(box)) return {over.value.least, kInfinity};
      const double centre = value(centreOf(box));
      if (std::isinf(centre)) return over.value;
      const Vec3 half = halfOf(box);
      Interval mean{centre, centre};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        mean = mean + over.slopes[axis] * Interval{-half[axis], half[axis]};
      }
      // The value in the centre is rounded, by more than its own size where terms cancel.
      const double room = 1e-14 * (std::abs(over.value.least) + std::abs(over.value.greatest));
      return both(over.value, outward(mean.least - room, mean.greatest + room));
    }
  }

  [[nodiscard]] double lipschitz(const Box& box) const override {
    if constexpr (Formula::kUnitGradient) return 1;
    double sum = 0;
    for (const Interval& slope : overBox(box).slopes) sum += square(abs(slope).greatest);
    return std::sqrt(sum);
  }

  [[nodiscard]] Box gradientBound(const Box& box) const override {
    std::array<Interval, 3> slopes = overBox(box).slopes;
    if constexpr (Formula::kUnitGradient) {
      for (Interval& slope : slopes) slope = both(slope, {-1, 1});
    }
    return boxOf(slopes);
  }

  [[nodiscard]] bool hasUnitGradient() const override { return Formula::kUnitGradient; }
  [[nodiscard]] Box extent() const override { return formula_.extent(); }
  [[nodiscard]] bool insideAlong(const Line& line, double /*begin*/, double /*end*/,
                                 std::vector<Interval>& spans) const override {
    if constexpr (requires { formula_.insideAlong(Vec3(), Vec3(), spans); }) {
      return formula_.insideAlong(line.from, line.direction, spans);
    }
    return false;
  }

 private:
  /// Where a formula has no derivative, as at the end of a root, 0 stands for it.
  static Position toPosition(const std::array<double, 3>& v) {
    const auto defined = [](double slope) { return std::isnan(slope) ? 0 : slope; };
    return {defined(v[0]), defined(v[1]), defined(v[2])};
  }

  [[nodiscard]] bool mayLackValues(const Box& box) const {
    if constexpr (requires { formula_.mayLackValues(Interval(), Interval(), Interval()); }) {
      return formula_.mayLackValues(sideOf(box, 0), sideOf(box, 1), sideOf(box, 2));
    }
    return false;
  }

  [[nodiscard]] Dual<double> dualAt(const Position& p) const {
    const auto v = variables<double>(p.x, p.y, p.z, 1);
    return formula_(v[0], v[1], v[2]);
  }
  [[nodiscard]] Dual<Interval> overBox(const Box& box) const {
    const auto v =
        variables<Interval>(sideOf(box, 0), sideOf(box, 1), sideOf(box, 2), Interval{1, 1});
    return formula_(v[0], v[1], v[2]);
  }

  Formula formula_;
};

template <class Formula>
std::shared_ptr<const Field> fieldOf(Formula formula) {
  return std::make_shared<FormulaField<Formula>>(std::move(formula));
}

}  // namespace tufa::implicit
