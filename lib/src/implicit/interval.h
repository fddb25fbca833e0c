#pragma once

#include <tufa/implicit.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

// Interval arithmetic (Moore 1966). Each operation encloses all results for operands of its
// intervals, rounding included: ends are moved outward by more than the error of the operation.

namespace tufa::implicit {

// Formulas are templates: these are what they call for plain numbers.
using std::abs;
using std::atan;
using std::cos;
using std::erf;
using std::exp;
using std::log;
using std::max;
using std::min;
using std::pow;
using std::sin;
using std::sqrt;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[nodiscard]] inline double square(double x) { return x * x; }
[[nodiscard]] inline Interval everything() { return {-kInfinity, kInfinity}; }
[[nodiscard]] inline bool holdsZero(const Interval& a) { return a.least <= 0 && a.greatest >= 0; }

/// Ends of a result that may be off by two units in the last place; everything for NaN.
[[nodiscard]] inline Interval outward(double least, double greatest) {
  constexpr double kError = 4 * std::numeric_limits<double>::epsilon();
  constexpr double kLeast = std::numeric_limits<double>::min();
  if (!(least <= greatest)) return everything();
  return {least * (least < 0 ? 1 + kError : 1 - kError) - kLeast,
          greatest * (greatest < 0 ? 1 - kError : 1 + kError) + kLeast};
}

[[nodiscard]] inline Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.least, b.least), std::max(a.greatest, b.greatest)};
}

/// What lies in both, for two bounds of one thing.
[[nodiscard]] inline Interval both(const Interval& a, const Interval& b) {
  const Interval c{std::max(a.least, b.least), std::min(a.greatest, b.greatest)};
  return c.least <= c.greatest ? c : a;
}

inline Interval operator-(const Interval& a) { return {-a.greatest, -a.least}; }
inline Interval operator+(const Interval& a, const Interval& b) {
  return outward(a.least + b.least, a.greatest + b.greatest);
}
inline Interval operator-(const Interval& a, const Interval& b) { return a + -b; }
inline Interval operator+(const Interval& a, double b) { return a + Interval{b, b}; }
inline Interval operator+(double a, const Interval& b) { return b + a; }
inline Interval operator-(const Interval& a, double b) { return a + -b; }
inline Interval operator-(double a, const Interval& b) { return -b + a; }

inline Interval operator*(const Interval& a, const Interval& b) {
  double p = a.least * b.least;
  double q = a.least * b.greatest;
  double r = a.greatest * b.least;
  double s = a.greatest * b.greatest;
  if (std::isnan(p + q + r + s)) {
    // 0 times an infinite end is 0: the end stands for numbers of any size, none of them infinite.
    const auto times = [](double x, double y) { return x == 0 || y == 0 ? 0 : x * y; };
    p = times(a.least, b.least);
    q = times(a.least, b.greatest);
    r = times(a.greatest, b.least);
    s = times(a.greatest, b.greatest);
  }
  return outward(std::min(std::min(p, q), std::min(r, s)),
                 std::max(std::max(p, q), std::max(r, s)));
}
inline Interval operator*(const Interval& a, double b) { return a * Interval{b, b}; }
inline Interval operator*(double a, const Interval& b) { return b * a; }

inline Interval operator/(const Interval& a, const Interval& b) {
  if (b.least > 0 || b.greatest < 0) return a * outward(1 / b.greatest, 1 / b.least);
  if (b.least == 0 && b.greatest > 0) return a * Interval{1 / b.greatest, kInfinity};
  if (b.greatest == 0 && b.least < 0) return a * Interval{-kInfinity, 1 / b.least};
  return everything();
}
inline Interval operator/(const Interval& a, double b) { return a / Interval{b, b}; }
inline Interval operator/(double a, const Interval& b) { return Interval{a, a} / b; }

[[nodiscard]] inline Interval abs(const Interval& a) {
  if (a.least >= 0) return a;
  if (a.greatest <= 0) return -a;
  return {0, std::max(-a.least, a.greatest)};
}
[[nodiscard]] inline Interval square(const Interval& a) {
  const Interval b = abs(a);
  const Interval c = outward(b.least * b.least, b.greatest * b.greatest);
  return {std::max(c.least, 0.0), c.greatest};
}
[[nodiscard]] inline Interval min(const Interval& a, const Interval& b) {
  return {std::min(a.least, b.least), std::min(a.greatest, b.greatest)};
}
[[nodiscard]] inline Interval max(const Interval& a, const Interval& b) {
  return {std::max(a.least, b.least), std::max(a.greatest, b.greatest)};
}
[[nodiscard]] inline Interval min(const Interval& a, double b) { return min(a, Interval{b, b}); }
[[nodiscard]] inline Interval max(const Interval& a, double b) { return max(a, Interval{b, b}); }

/// Of the part that is not negative.
[[nodiscard]] inline Interval sqrt(const Interval& a) {
  const double greatest = std::sqrt(std::max(a.greatest, 0.0));
  const Interval c = outward(std::sqrt(std::max(a.least, 0.0)), greatest);
  return {std::max(c.least, 0.0), c.greatest};
}

/// Of what is not negative.
[[nodiscard]] inline Interval pow(const Interval& a, double power) {
  const double p = std::pow(std::max(a.least, 0.0), power);
  const double q = std::pow(std::max(a.greatest, 0.0), power);
  const Interval c = outward(std::min(p, q), std::max(p, q));
  return {std::max(c.least, 0.0), c.greatest};
}

/// Of a function that grows everywhere.
template <class Function>
Interval ofGrowing(const Interval& a, const Function& function) {
  return outward(function(a.least), function(a.greatest));
}
[[nodiscard]] inline Interval exp(const Interval& a) {
  const Interval c = ofGrowing(a, [](double x) { return std::exp(x); });
  return {std::max(c.least, 0.0), c.greatest};
}
/// Of the part above 0.
[[nodiscard]] inline Interval log(const Interval& a) {
  if (!(a.greatest > 0)) return everything();
  return ofGrowing(Interval{std::max(a.least, 0.0), a.greatest},
                   [](double x) { return std::log(x); });
}
[[nodiscard]] inline Interval atan(const Interval& a) {
  return ofGrowing(a, [](double x) { return std::atan(x); });
}

[[nodiscard]] inline Interval sin(const Interval& a) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double width = a.greatest - a.least;
  if (!(width < kTurn)) return {-1, 1};
  // Room for the rounding of the quotient.
  const double room = 1e-14 * (1 + std::max(std::abs(a.least), std::abs(a.greatest)));
  // Whether phase + a whole number of turns lies inside.
  const auto holds = [&](double phase) {
    const double turns = std::ceil((a.least - room - phase) / kTurn);
    return phase + turns * kTurn <= a.greatest + room;
  };
  const double p = std::sin(a.least);
  const double q = std::sin(a.greatest);
  const Interval c = outward(std::min(p, q), std::max(p, q));
  return {holds(-kTurn / 4) ? -1 : std::max(c.least, -1.0),
          holds(kTurn / 4) ? 1 : std::min(c.greatest, 1.0)};
}
[[nodiscard]] inline Interval cos(const Interval& a) {
  // One rounding of the sum, of less than its last place.
  return sin(a + std::numbers::pi / 2);
}

}  // namespace tufa::implicit
