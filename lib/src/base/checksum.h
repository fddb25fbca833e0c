#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace tufa::base {

/// FNV-1a of 64 bits: tells files apart that were mixed up or damaged, not those that someone made
/// to look the same.
class Checksum {
 public:
  void add(std::string_view bytes) {
    constexpr std::uint64_t kPrime = 0x100000001b3;
    for (const char byte : bytes) sum_ = (sum_ ^ static_cast<unsigned char>(byte)) * kPrime;
  }

  /// Of numbers as they are in memory, of types without padding.
  template <class T>
  void addAll(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
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

}  // namespace tufa::base
