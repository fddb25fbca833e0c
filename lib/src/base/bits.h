#pragma once

#include <bit>
#include <cstdint>

namespace tufa::base {

/// Calls body(index) for each set bit, lowest first.
template <class Body>
inline void forEachBit(std::uint64_t word, Body&& body) {
  while (word != 0) {
    body(std::countr_zero(word));
    word &= word - 1;
  }
}

/// Number of set bits. Written out because the baseline instruction set has no population count and
/// the library call it would become costs several times as much.
inline int countBits(std::uint64_t word) {
  word -= (word >> 1) & 0x5555555555555555u;
  word = (word & 0x3333333333333333u) + ((word >> 2) & 0x3333333333333333u);
  word = (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return static_cast<int>((word * 0x0101010101010101u) >> 56);
}

/// The bits below bit `index`.
inline std::uint64_t bitsBelow(int index) { return (std::uint64_t{1} << index) - 1; }

/// Puts two zero bits between the lowest 21 bits of `x`. Three of these, shifted by 0, 1 and 2,
/// make a Morton code.
inline std::uint64_t spreadBits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

/// Mixes all bits of a number, so that numbers near each other become far ones (the last steps of
/// SplitMix64; Steele, Lea and Flood 2014).
inline std::uint64_t mixBits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace tufa::base
