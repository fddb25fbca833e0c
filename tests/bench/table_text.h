#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace tufa::bench {

/// A number in one printf format that takes a double.
inline std::string number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// With a comma every three digits.
inline std::string count(std::size_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

}  // namespace tufa::bench
