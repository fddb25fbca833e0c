#pragma once

#include <cstdint>

namespace tufa::shapes {

/// Mixes the bits of a 64-bit number so that near inputs give unrelated outputs (the finalizer of
/// SplitMix64, Steele, Lea and Flood 2014). A random number is a function of its place, so the
/// order in which threads ask for it does not matter.
[[nodiscard]] inline std::uint64_t mixBits(std::uint64_t bits) {
  bits += 0x9E3779B97F4A7C15u;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
  return bits ^ (bits >> 31);
}

/// A random number that belongs to a seed and a place, uniform in [0, 1).
[[nodiscard]] inline double randomAt(std::uint64_t seed, std::int64_t x, std::int64_t y,
                                     std::int64_t z) {
  std::uint64_t bits = mixBits(seed);
  bits = mixBits(bits ^ static_cast<std::uint64_t>(x));
  bits = mixBits(bits ^ static_cast<std::uint64_t>(y));
  bits = mixBits(bits ^ static_cast<std::uint64_t>(z));
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

}  // namespace tufa::shapes
