#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tufa::base {

/// How many bytes at the front of a text are one character of UTF-8 that a terminal shows; 0 if
/// they are none: control characters, marks that turn the direction of writing, and bytes that are
/// no UTF-8.
inline std::size_t shownBytes(std::string_view text) {
  const auto at = [&](std::size_t n) { return static_cast<unsigned char>(text[n]); };
  const unsigned first = at(0);
  constexpr unsigned kDelete = 0x7F;
  if (first < 0x80) return first >= ' ' && first != kDelete ? 1 : 0;
  const std::size_t count = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || count > text.size()) return 0;
  std::uint32_t code = first & (0xFFU >> (count + 1));
  for (std::size_t n = 1; n < count; ++n) {
    if ((at(n) & 0xC0U) != 0x80U) return 0;
    code = code << 6U | (at(n) & 0x3FU);
  }
  const bool tooLong = (count == 3 && code < 0x800) || (count == 4 && code < 0x10000);
  const bool control = code < 0xA0 || code == 0x2028 || code == 0x2029;
  const bool turns = code == 0x061C || code == 0x200E || code == 0x200F ||
                     (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
  const bool noCharacter = (code >= 0xD800 && code <= 0xDFFF) || code > 0x10FFFF;
  return tooLong || control || turns || noCharacter ? 0 : count;
}

/// A text of unknown origin as one line for a terminal or a log: what is not shown becomes \xNN.
inline std::string printable(std::string_view text) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string line;
  while (!text.empty()) {
    const std::size_t count = shownBytes(text);
    if (count > 0) {
      line += text.substr(0, count);
    } else {
      const auto byte = static_cast<unsigned char>(text[0]);
      line += {'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
    text.remove_prefix(count > 0 ? count : 1);
  }
  return line;
}

}  // namespace tufa::base
