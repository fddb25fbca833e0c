#pragma once

#include <cstdio>
#include <string>

namespace tufa::bench {

/// A number in one printf format that takes a double.
inline std::string number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace tufa::bench
