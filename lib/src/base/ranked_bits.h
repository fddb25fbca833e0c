#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tufa::base {

/// A set of numbers that tells how many of them are below another one: where each is, once they
/// alone are left. 1.5 bits a number.
class RankedBits {
 public:
  /// Of numbers below `size`; none at first.
  explicit RankedBits(std::size_t size) : words_((size + 63) / 64, 0) {}

  void add(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << i % 64; }
  [[nodiscard]] bool has(std::size_t i) const { return (words_[i / 64] >> i % 64 & 1) != 0; }
  /// To be called once all are added.
  void count() {
    before_.resize(words_.size());
    for (std::size_t word = 0; word < words_.size(); ++word) {
      before_[word] = size_;
      size_ += static_cast<std::uint32_t>(std::popcount(words_[word]));
    }
  }
  [[nodiscard]] std::uint32_t size() const { return size_; }
  /// How many are below i.
  [[nodiscard]] std::uint32_t rank(std::size_t i) const {
    const std::uint64_t below = (std::uint64_t{1} << i % 64) - 1;
    return before_[i / 64] + static_cast<std::uint32_t>(std::popcount(words_[i / 64] & below));
  }
  /// f(i) for all of them, rising.
  template <class F>
  void forAll(const F& f) const {
    for (std::size_t word = 0; word < words_.size(); ++word) {
      for (std::uint64_t left = words_[word]; left != 0; left &= left - 1) {
        f(64 * word + static_cast<std::size_t>(std::countr_zero(left)));
      }
    }
  }

 private:
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;
  std::uint32_t size_ = 0;
};

}  // namespace tufa::base
