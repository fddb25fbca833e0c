#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace tufa::tools {

/// The number that a whole text is, if it is one.
template <class Number>
[[nodiscard]] std::optional<Number> numberIn(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace tufa::tools
