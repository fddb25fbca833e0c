#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tufa::io {

/// FNV-1a of 64 bits: tells files apart that were mixed up or damaged, not those that someone made
/// to look the same.
class Checksum {
 public:
  void add(std::string_view bytes) {
    constexpr std::uint64_t kPrime = 0x100000001b3;
    for (const char byte : bytes) sum_ = (sum_ ^ static_cast<unsigned char>(byte)) * kPrime;
  }

  /// 16 hexadecimal digits.
  [[nodiscard]] std::string text() const {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string digits;
    for (int shift = 60; shift >= 0; shift -= 4) digits += kDigits[sum_ >> shift & 15U];
    return digits;
  }

 private:
  std::uint64_t sum_ = 0xcbf29ce484222325;
};

}  // namespace tufa::io
