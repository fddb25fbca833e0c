#include "implicit/expression.h"

#include <tufa/error.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include "base/number_text.h"
#include "implicit/fields.h"
#include "implicit/formula_field.h"

namespace tufa::implicit {
namespace {

constexpr std::size_t kMostSteps = 10000;
constexpr std::size_t kDeepest = 200;  ///< parentheses in each other: the parser calls itself

/// By recursive descent:
///     sum     = product (('+' | '-') product)*
///     product = sign (('*' | '/') sign)*
///     sign    = ('+' | '-')* power
///     power   = atom ('^' sign)?             -2^2 is -4, 2^3^2 is 2^9
///     atom    = number | name | name '(' sum (',' sum)? ')' | '(' sum ')'
class Parser {
  using Line = Expression::Line;

 public:
  explicit Parser(std::string_view text) : text_(text) {}

  std::vector<Line> parse() {
    const std::uint32_t last = parseSum();
    if (peek() != '\0' || place_ < text_.size()) fail("an operator is due here");
    // The last line is the value.
    if (last + 1 != lines_.size()) append({Step::Add, last, number(0)}, false);
    return std::move(lines_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    constexpr std::size_t kShown = 12;
    const std::string here(text_.substr(std::min(place_, text_.size()), kShown));
    throw Error(ErrorCode::InvalidArgument,
                "at character " + std::to_string(place_ + 1) + " of the expression" +
                    (here.empty() ? ", its end: " : " (\"" + here + "\"): ") + why);
  }

  char peek() {
    while (place_ < text_.size() && (text_[place_] == ' ' || text_[place_] == '\t')) ++place_;
    return place_ < text_.size() ? text_[place_] : '\0';
  }
  bool take(char c) {
    if (peek() != c || place_ >= text_.size()) return false;
    ++place_;
    return true;
  }

  std::uint32_t append(const Line& line, bool share = true) {
    const auto key = std::make_tuple(line.step, line.first, line.second, line.number);
    const auto known = places_.find(key);
    if (share && known != places_.end()) return known->second;
    if (lines_.size() >= kMostSteps) {
      fail("it has more than " + std::to_string(kMostSteps) + " operations");
    }
    lines_.push_back(line);
    const auto place = static_cast<std::uint32_t>(lines_.size() - 1);
    places_[key] = place;
    return place;
  }
  std::uint32_t number(double value) { return append({Step::Constant, 0, 0, value}); }
  /// What has a value, and is of numbers alone, is a number.
  std::uint32_t apply(const Line& line, bool ofNumbers) {
    if (!ofNumbers) return append(line);
    const double value =
        Expression::apply(line, lines_[line.first].number, lines_[line.second].number);
    return std::isfinite(value) ? number(value) : append(line);
  }
  std::uint32_t apply(Step step, std::uint32_t a, double number = 0) {
    return apply({step, a, a, number}, isNumber(a));
  }
  std::uint32_t apply(Step step, std::uint32_t a, std::uint32_t b) {
    return apply({step, a, b, 0}, isNumber(a) && isNumber(b));
  }
  [[nodiscard]] bool isNumber(std::uint32_t line) const {
    return lines_[line].step == Step::Constant;
  }

  std::uint32_t parseSum() {
    if (++depth_ > kDeepest) fail("it is nested deeper than " + std::to_string(kDeepest));
    std::uint32_t sum = parseProduct();
    while (true) {
      if (take('+')) {
        sum = apply(Step::Add, sum, parseProduct());
      } else if (take('-')) {
        sum = apply(Step::Subtract, sum, parseProduct());
      } else {
        --depth_;
        return sum;
      }
    }
  }

  std::uint32_t parseProduct() {
    std::uint32_t product = parseSign();
    while (true) {
      if (take('*')) {
        product = multiply(product, parseSign());
      } else if (take('/')) {
        product = apply(Step::Divide, product, parseSign());
      } else {
        return product;
      }
    }
  }

  std::uint32_t parseSign() {
    bool negative = false;
    while (peek() == '+' || peek() == '-') {
      if (take('-')) {
        negative = !negative;
      } else {
        take('+');
      }
    }
    const std::uint32_t power = parsePower();
    if (!negative) return power;
    return apply(Step::Negate, power);
  }

  std::uint32_t parsePower() {
    const std::uint32_t base = parseAtom();
    if (!take('^')) return base;
    if (++depth_ > kDeepest) fail("it is nested deeper than " + std::to_string(kDeepest));
    const std::uint32_t exponent = parseSign();
    --depth_;
    return raise(base, exponent);
  }

  std::uint32_t parseAtom() {
    const char c = peek();
    if (take('(')) {
      const std::uint32_t inner = parseSum();
      if (!take(')')) fail("a closing parenthesis is due here");
      return inner;
    }
    if ((c >= '0' && c <= '9') || c == '.') return parseNumber();
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) return parseName();
    fail("a number, x, y, z, a function or a parenthesis is due here");
  }

  std::uint32_t parseNumber() {
    double value = 0;
    const char* const begin = text_.data() + place_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) fail("this number cannot be used");
    place_ += static_cast<std::size_t>(end - begin);
    return number(value);
  }

  std::uint32_t parseName() {
    const std::size_t begin = place_;
    while (place_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[place_])) != 0 || text_[place_] == '_')) {
      ++place_;
    }
    const std::string name(text_.substr(begin, place_ - begin));
    if (name == "x") return append({Step::X});
    if (name == "y") return append({Step::Y});
    if (name == "z") return append({Step::Z});
    if (name == "pi") return number(std::numbers::pi);
    if (name == "e") return number(std::numbers::e);
    return parseCall(name, begin);
  }

  std::uint32_t parseCall(const std::string& name, std::size_t begin) {
    static const std::map<std::string, Step> kOne = {
        {"abs", Step::Absolute},   {"sqrt", Step::Root}, {"exp", Step::Exponential},
        {"ln", Step::Logarithm},   {"sin", Step::Sine},  {"cos", Step::Cosine},
        {"atan", Step::Arctangent}};
    static const std::map<std::string, Step> kTwo = {{"min", Step::Least}, {"max", Step::Greatest}};
    const auto one = kOne.find(name);
    const auto two = kTwo.find(name);
    const bool tangent = name == "tan";
    if (one == kOne.end() && two == kTwo.end() && !tangent) {
      place_ = begin;
      fail("there is no " + name +
           "; there are x, y, z, pi, e, abs, sqrt, exp, ln, sin, cos, tan, atan, min and max");
    }
    if (!take('(')) fail(name + " needs its argument in parentheses");
    const std::uint32_t first = parseSum();
    std::uint32_t result = 0;
    if (two != kTwo.end()) {
      if (!take(',')) fail(name + " needs two arguments with a comma between them");
      result = apply(two->second, first, parseSum());
    } else if (tangent) {
      result = apply(Step::Divide, apply(Step::Sine, first), apply(Step::Cosine, first));
    } else {
      result = apply(one->second, first);
    }
    if (!take(')')) fail("a closing parenthesis is due here");
    return result;
  }

  // The bound of a square is tighter than that of a product.
  std::uint32_t multiply(std::uint32_t a, std::uint32_t b) {
    return a == b ? apply(Step::Square, a) : apply(Step::Multiply, a, b);
  }

  std::uint32_t raise(std::uint32_t base, std::uint32_t exponent) {
    constexpr double kMostWhole = 1e6;
    if (isNumber(exponent)) {
      const double power = lines_[exponent].number;
      if (power == std::floor(power) && std::abs(power) <= kMostWhole) {
        const std::uint32_t whole = raiseWhole(base, static_cast<unsigned>(std::abs(power)));
        return power < 0 ? apply(Step::Divide, number(1), whole) : whole;
      }
      // Of bases that are not negative, as with sqrt and ln.
      return power == 0.5 ? apply(Step::Root, base) : apply(Step::Power, base, power);
    }
    return apply(Step::Exponential, multiply(exponent, apply(Step::Logarithm, base)));
  }

  // Even powers as squares, whose bounds know that they are not negative.
  std::uint32_t raiseWhole(std::uint32_t base, unsigned power) {
    if (power == 0) return number(1);
    if (power == 1) return base;
    if (power % 2 == 0) return apply(Step::Square, raiseWhole(base, power / 2));
    return multiply(base, raiseWhole(base, power - 1));
  }

  std::string_view text_;
  std::size_t place_ = 0;
  std::size_t depth_ = 0;
  std::vector<Line> lines_;
  std::map<std::tuple<Step, std::uint32_t, std::uint32_t, double>, std::uint32_t> places_;
};

bool mayBeInfinite(const Interval& a) { return !(a.least > -kInfinity && a.greatest < kInfinity); }

/// Whether a step may make NaN of numbers of its operands' ranges.
bool mayMakeNaN(Step step, const Interval& a, const Interval& b) {
  switch (step) {
    case Step::Add:
    case Step::Subtract:
      return mayBeInfinite(a) && mayBeInfinite(b);
    case Step::Multiply:
      return (holdsZero(a) && mayBeInfinite(b)) || (mayBeInfinite(a) && holdsZero(b));
    case Step::Divide:
      return (holdsZero(a) && holdsZero(b)) || (mayBeInfinite(a) && mayBeInfinite(b));
    case Step::Sine:
    case Step::Cosine:
      return mayBeInfinite(a);
    default:
      return false;
  }
}

}  // namespace

Expression::Expression(std::string_view text) : lines_(Parser(text).parse()) {}

bool Expression::mayLackValues(const Interval& x, const Interval& y, const Interval& z) const {
  return withRoom<Interval>([&](Interval* values) {
    run(values, x, y, z);
    return std::any_of(lines_.begin(), lines_.end(), [&](const Expression::Line& line) {
      return mayMakeNaN(line.step, values[line.first], values[line.second]);
    });
  });
}

std::shared_ptr<const Field> makeExpression(std::string_view text) {
  return fieldOf(Expression(text));
}

}  // namespace tufa::implicit
