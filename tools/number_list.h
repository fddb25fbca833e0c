#pragma once

#include <CLI/CLI.hpp>

#include <tufa/error.h>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "number.h"

namespace tufa::tools {

/// As many numbers as asked for, with commas between them. Throws Error(InvalidArgument), which
/// names the option.
template <std::size_t N>
std::array<double, N> numbersIn(const std::string& option, const std::string& text) {
  std::array<double, N> all{};
  const std::vector<std::string> words = CLI::detail::split(text, ',');
  for (std::size_t n = 0; n < words.size(); ++n) {
    const auto number = numberIn<double>(words[n]);
    if (words.size() != N || !number || !std::isfinite(*number)) {
      throw Error(ErrorCode::InvalidArgument, option + " takes " + std::to_string(N) +
                                                  " numbers with commas between them, not \"" +
                                                  text + "\"");
    }
    all[n] = *number;
  }
  return all;
}

}  // namespace tufa::tools
