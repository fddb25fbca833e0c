#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <vector>

#include "implicit/boxes.h"
#include "implicit/dual.h"
#include "implicit/interval.h"

namespace tufa::implicit {

/// What a step of an expression does with one or two earlier ones.
enum class Step : std::uint8_t {
  Constant,
  X,
  Y,
  Z,
  Add,
  Subtract,
  Multiply,
  Divide,
  Least,
  Greatest,
  Negate,
  Absolute,
  Square,
  Root,
  Power,  ///< by a number of its own
  Exponential,
  Logarithm,
  Sine,
  Cosine,
  Arctangent,
};

/// An expression in x, y and z as a list of steps, each of which comes after those that it uses.
/// Equal steps are one, and those of numbers alone are numbers.
class Expression {
 public:
  static constexpr bool kUnitGradient = false;

  /// Throws Error(InvalidArgument), which names the place in the text.
  explicit Expression(std::string_view text);

  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    return withRoom<T>([&](T* values) { return run(values, x, y, z); });
  }

  /// Whether there may be points in a box without a value, such as 0/0, or infinity without itself
  /// where numbers overflow. Bounds of what is made of them, as atan(0/0), do not tell.
  [[nodiscard]] bool mayLackValues(const Interval& x, const Interval& y, const Interval& z) const;

  [[nodiscard]] static Box extent() { return wholeSpace(); }

  /// One step.
  struct Line {
    Step step = Step::Constant;
    std::uint32_t first = 0;
    std::uint32_t second = 0;
    double number = 0;
    friend bool operator==(const Line&, const Line&) = default;
  };

  /// What a step makes of the values of earlier ones.
  template <class T>
  static T apply(const Line& line, const T& a, const T& b) {
    switch (line.step) {
      case Step::Add:
        return a + b;
      case Step::Subtract:
        return a - b;
      case Step::Multiply:
        return a * b;
      case Step::Divide:
        return a / b;
      case Step::Least:
        return least(a, b);
      case Step::Greatest:
        return -least<T>(-a, -b);
      case Step::Negate:
        return -a;
      case Step::Absolute:
        return abs(a);
      case Step::Square:
        return square(a);
      // Of what is not negative, so that every point has a value.
      case Step::Root:
        return sqrt(max(a, 0.0));
      case Step::Power:
        return pow(max(a, 0.0), line.number);
      case Step::Exponential:
        return exp(a);
      case Step::Logarithm:
        return log(max(a, 0.0));
      case Step::Sine:
        return sin(a);
      case Step::Cosine:
        return cos(a);
      case Step::Arctangent:
        return atan(a);
      case Step::Constant:
      case Step::X:
      case Step::Y:
      case Step::Z:
        break;
    }
    return literal<T>(line.number);
  }

 private:
  /// Most expressions do with so many: no memory is asked for at each point.
  static constexpr std::size_t kFew = 64;

  /// Calls use(values) with room for the value of each step.
  template <class T, class Use>
  auto withRoom(const Use& use) const {
    if (lines_.size() <= kFew) {
      std::array<T, kFew> values;
      return use(values.data());
    }
    std::vector<T> values(lines_.size());
    return use(values.data());
  }

  template <class T>
  static T literal(double number) {
    if constexpr (std::is_same_v<T, double>) {
      return number;
    } else if constexpr (std::is_same_v<T, Interval>) {
      return {number, number};
    } else {
      return constant(literal<std::remove_cvref_t<decltype(T::value)>>(number));
    }
  }

  /// The lesser of two numbers, NaN if either is. Bounds are of values that are there.
  template <class T>
  static T least(const T& a, const T& b) {
    if constexpr (std::is_same_v<T, double>) {
      return std::isnan(b) ? b : min(a, b);
    } else if constexpr (std::is_same_v<T, Dual<double>>) {
      return std::isnan(b.value) ? b : min(a, b);
    } else {
      return min(a, b);
    }
  }

  template <class T>
  T run(T* values, const T& x, const T& y, const T& z) const {
    for (std::size_t n = 0; n < lines_.size(); ++n) {
      const Line& line = lines_[n];
      switch (line.step) {
        case Step::Constant:
          values[n] = literal<T>(line.number);
          break;
        case Step::X:
          values[n] = x;
          break;
        case Step::Y:
          values[n] = y;
          break;
        case Step::Z:
          values[n] = z;
          break;
        default:
          values[n] = apply(line, values[line.first], values[line.second]);
      }
    }
    return values[lines_.size() - 1];
  }

  std::vector<Line> lines_;
};

}  // namespace tufa::implicit
