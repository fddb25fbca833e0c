#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tufa::base {

/// A set of numbers that several threads add to at a time.
class AtomicBits {
 public:
  /// Of numbers below `size`; none at first.
  explicit AtomicBits(std::size_t size) : words_((size + 63) / 64, 0) {}

  /// Whether the number was there before.
  bool add(std::size_t i) {
    const std::uint64_t bit = std::uint64_t{1} << i % 64;
    std::atomic_ref<std::uint64_t> word(words_[i / 64]);
    if ((word.load(std::memory_order_relaxed) & bit) != 0) return true;  // mostly, for vertices
    return (word.fetch_or(bit, std::memory_order_relaxed) & bit) != 0;
  }
  /// Not while others are added.
  [[nodiscard]] bool has(std::size_t i) const { return (words_[i / 64] >> i % 64 & 1) != 0; }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace tufa::base
