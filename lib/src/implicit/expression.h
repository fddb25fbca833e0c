#pragma once

#include <array>
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
  Exponential,
  Logarithm,
  Sine,
  Cosine,
  Arctangent,
};

/// An expression in x, y and z as a list of steps, each of which comes after those that it uses.
/// Equal steps are one.
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

  template <class T>
  T run(T* values, const T& x, const T& y, const T& z) const {
    for (std::size_t n = 0; n < lines_.size(); ++n) {
      const Line& line = lines_[n];
      const T& a = values[line.first];
      const T& b = values[line.second];
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
        case Step::Add:
          values[n] = a + b;
          break;
        case Step::Subtract:
          values[n] = a - b;
          break;
        case Step::Multiply:
          values[n] = a * b;
          break;
        case Step::Divide:
          values[n] = a / b;
          break;
        case Step::Least:
          values[n] = min(a, b);
          break;
        case Step::Greatest:
          values[n] = max(a, b);
          break;
        case Step::Negate:
          values[n] = -a;
          break;
        case Step::Absolute:
          values[n] = abs(a);
          break;
        case Step::Square:
          values[n] = square(a);
          break;
        // Of what is not negative, so that every point has a value.
        case Step::Root:
          values[n] = sqrt(max(a, 0.0));
          break;
        case Step::Exponential:
          values[n] = exp(a);
          break;
        case Step::Logarithm:
          values[n] = log(max(a, 0.0));
          break;
        case Step::Sine:
          values[n] = sin(a);
          break;
        case Step::Cosine:
          values[n] = cos(a);
          break;
        case Step::Arctangent:
          values[n] = atan(a);
          break;
      }
    }
    return values[lines_.size() - 1];
  }

  std::vector<Line> lines_;
};

}  // namespace tufa::implicit
