#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <system_error>

namespace tufa::base {

/// A number for a message: the shortest text that reads back to the same value, "1e-300" rather
/// than "0.000000".
inline std::string numberText(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

/// An estimate for a message: three significant digits, without an exponent.
inline std::string roughNumberText(double value) {
  std::array<char, 64> text;
  const double size = std::abs(value);
  const double step = size < 1e-9 ? 1 : std::pow(10, std::floor(std::log10(size)) - 2);
  const double rounded = std::round(value / step) * step;
  const int decimals = step < 1 ? static_cast<int>(std::lround(-std::log10(step))) : 0;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), rounded,
                                          std::chars_format::fixed, decimals);
  return error == std::errc() ? std::string(text.data(), end) : numberText(value);
}

/// Three significant digits, with an exponent where that is shorter: for what may be tiny.
inline std::string shortNumberText(double value) {
  std::array<char, 32> text;
  constexpr int kDigits = 3;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                 std::chars_format::general, kDigits)
                       .ptr;
  return {text.data(), end};
}

/// The same as roughNumberText(), of an estimate that is above a limit, or its whole number where
/// three digits are not.
inline std::string roughNumberAbove(double value, double limit) {
  const double step = std::pow(10, std::floor(std::log10(std::abs(value))) - 2);
  return std::round(value / step) * step > limit ? roughNumberText(value)
                                                 : numberText(std::ceil(value));
}

}  // namespace tufa::base
