#pragma once

#include <array>
#include <cmath>

#include "implicit/interval.h"

// Automatic differentiation in forward mode (Wengert 1964): a number and its three derivatives, of
// plain numbers or of intervals.

namespace tufa::implicit {

template <class T>
struct Dual {
  T value;
  std::array<T, 3> slopes;  ///< by x, y and z
};

/// A number whose derivatives are 0.
template <class T>
Dual<T> constant(const T& value) {
  return {value, {T{}, T{}, T{}}};
}

// Derivatives of 0 stay 0, as with intervals: what does not change by a coordinate does not begin
// to where it meets an infinite slope.
inline double times(double slope, double by) { return slope == 0 ? 0 : slope * by; }
inline double over(double slope, double by) { return slope == 0 ? 0 : slope / by; }
inline Interval times(const Interval& slope, const Interval& by) { return slope * by; }
inline Interval over(const Interval& slope, const Interval& by) { return slope / by; }

/// f(x), where `slope` is f'(x).
template <class T>
Dual<T> chain(const T& value, const T& slope, const Dual<T>& x) {
  return {value, {times(x.slopes[0], slope), times(x.slopes[1], slope), times(x.slopes[2], slope)}};
}

template <class T>
Dual<T> operator-(const Dual<T>& a) {
  return {-a.value, {-a.slopes[0], -a.slopes[1], -a.slopes[2]}};
}
template <class T>
Dual<T> operator+(const Dual<T>& a, const Dual<T>& b) {
  return {a.value + b.value,
          {a.slopes[0] + b.slopes[0], a.slopes[1] + b.slopes[1], a.slopes[2] + b.slopes[2]}};
}
template <class T>
Dual<T> operator-(const Dual<T>& a, const Dual<T>& b) {
  return {a.value - b.value,
          {a.slopes[0] - b.slopes[0], a.slopes[1] - b.slopes[1], a.slopes[2] - b.slopes[2]}};
}
template <class T>
Dual<T> operator*(const Dual<T>& a, const Dual<T>& b) {
  Dual<T> c{a.value * b.value, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    c.slopes[i] = times(a.slopes[i], b.value) + times(b.slopes[i], a.value);
  }
  return c;
}
template <class T>
Dual<T> operator/(const Dual<T>& a, const Dual<T>& b) {
  Dual<T> c{a.value / b.value, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    c.slopes[i] = over(a.slopes[i] - times(b.slopes[i], c.value), b.value);
  }
  return c;
}
template <class T>
Dual<T> operator+(const Dual<T>& a, double b) {
  return {a.value + b, a.slopes};
}
template <class T>
Dual<T> operator+(double a, const Dual<T>& b) {
  return b + a;
}
template <class T>
Dual<T> operator-(const Dual<T>& a, double b) {
  return {a.value - b, a.slopes};
}
template <class T>
Dual<T> operator-(double a, const Dual<T>& b) {
  return -b + a;
}
template <class T>
Dual<T> operator*(const Dual<T>& a, double b) {
  return {a.value * b, {a.slopes[0] * b, a.slopes[1] * b, a.slopes[2] * b}};
}
template <class T>
Dual<T> operator*(double a, const Dual<T>& b) {
  return b * a;
}
template <class T>
Dual<T> operator/(const Dual<T>& a, double b) {
  return a * (1 / b);
}
template <class T>
Dual<T> operator/(double a, const Dual<T>& b) {
  const T value = a / b.value;
  return chain(value, -value / b.value, b);
}

template <class T>
Dual<T> square(const Dual<T>& x) {
  return chain(square(x.value), 2.0 * x.value, x);
}
/// 0 is where a distance begins: there is no derivative, and 0 stands for it.
inline Dual<double> sqrt(const Dual<double>& x) {
  const double root = std::sqrt(x.value);
  return chain(root, root > 0 ? 0.5 / root : 0.0, x);
}
inline Dual<Interval> sqrt(const Dual<Interval>& x) {
  const Interval root = sqrt(x.value);
  return chain(root, 0.5 / root, x);
}
/// Of what is not negative. 0 stands for the derivative at the power's end, as at that of a root.
inline Dual<double> pow(const Dual<double>& x, double power) {
  const double slope = x.value > 0 ? power * std::pow(x.value, power - 1) : 0.0;
  return chain(std::pow(x.value, power), slope, x);
}
inline Dual<Interval> pow(const Dual<Interval>& x, double power) {
  return chain(pow(x.value, power), power * pow(x.value, power - 1), x);
}
/// The length of a vector.
template <class T>
T norm(const T& x, const T& y, const T& z) {
  return sqrt(square(x) + square(y) + square(z));
}
/// It changes by no more than the vector does, also where it is 0 and the root's slope infinite.
inline Dual<Interval> norm(const Dual<Interval>& x, const Dual<Interval>& y,
                           const Dual<Interval>& z) {
  Dual<Interval> root = sqrt(square(x) + square(y) + square(z));
  for (std::size_t i = 0; i < 3; ++i) {
    const double most = norm(abs(x.slopes[i]), abs(y.slopes[i]), abs(z.slopes[i])).greatest;
    root.slopes[i] = both(root.slopes[i], {-most, most});
  }
  return root;
}

template <class T>
Dual<T> exp(const Dual<T>& x) {
  const T value = exp(x.value);
  return chain(value, value, x);
}
template <class T>
Dual<T> log(const Dual<T>& x) {
  return chain(log(x.value), 1.0 / x.value, x);
}
template <class T>
Dual<T> sin(const Dual<T>& x) {
  return chain(sin(x.value), cos(x.value), x);
}
template <class T>
Dual<T> cos(const Dual<T>& x) {
  return chain(cos(x.value), -sin(x.value), x);
}
template <class T>
Dual<T> atan(const Dual<T>& x) {
  return chain(atan(x.value), 1.0 / (square(x.value) + 1.0), x);
}
inline Dual<double> erf(const Dual<double>& x) {
  return chain(std::erf(x.value), 2 * std::numbers::inv_sqrtpi * std::exp(-x.value * x.value), x);
}

inline Dual<double> min(const Dual<double>& a, const Dual<double>& b) {
  return b.value < a.value ? b : a;
}
/// Where either may be the lesser, the derivatives may be those of either.
inline Dual<Interval> min(const Dual<Interval>& a, const Dual<Interval>& b) {
  if (a.value.greatest < b.value.least) return a;
  if (b.value.greatest < a.value.least) return b;
  Dual<Interval> c{min(a.value, b.value), {}};
  for (std::size_t i = 0; i < 3; ++i) c.slopes[i] = hull(a.slopes[i], b.slopes[i]);
  return c;
}

/// One where x is below 0, the other elsewhere.
inline double choose(double x, double below, double other) { return x < 0 ? below : other; }
inline Interval choose(const Interval& x, const Interval& below, const Interval& other) {
  if (x.greatest < 0) return below;
  return x.least >= 0 ? other : hull(below, other);
}
template <class T>
Dual<T> choose(const Dual<T>& x, const Dual<T>& below, const Dual<T>& other) {
  Dual<T> c{choose(x.value, below.value, other.value), {}};
  for (std::size_t i = 0; i < 3; ++i) {
    c.slopes[i] = choose(x.value, below.slopes[i], other.slopes[i]);
  }
  return c;
}

template <class T>
Dual<T> max(const Dual<T>& a, const Dual<T>& b) {
  return -min(-a, -b);
}
template <class T>
Dual<T> abs(const Dual<T>& a) {
  return max(a, -a);
}
inline Dual<double> abs(const Dual<double>& a) { return a.value < 0 ? -a : a; }
inline Dual<double> min(const Dual<double>& a, double b) { return min(a, constant(b)); }
inline Dual<double> max(const Dual<double>& a, double b) { return max(a, constant(b)); }
inline Dual<Interval> min(const Dual<Interval>& a, double b) {
  return min(a, constant(Interval{b, b}));
}
inline Dual<Interval> max(const Dual<Interval>& a, double b) {
  return max(a, constant(Interval{b, b}));
}

}  // namespace tufa::implicit
