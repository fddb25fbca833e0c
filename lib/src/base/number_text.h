#pragma once

#include <array>
#include <charconv>
#include <string>

namespace tufa::base {

/// A number for a message: the shortest text that reads back to the same value, "1e-300" rather
/// than "0.000000".
inline std::string numberText(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

}  // namespace tufa::base
