#pragma once

#include <tufa/export.h>

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>

namespace tufa {

/// Integer coordinates: of a lattice point, or of a cell, block or chunk in units of its own size.
/// The same numbers as openvdb::Coord has, without its header.
class Coord {
 public:
  constexpr Coord() = default;  ///< (0, 0, 0)
  /// (all, all, all).
  constexpr explicit Coord(std::int32_t all) : at_{all, all, all} {}
  /// (x, y, z).
  constexpr Coord(std::int32_t x, std::int32_t y, std::int32_t z) : at_{x, y, z} {}

  /// Coordinate along axis 0, 1 or 2.
  constexpr std::int32_t& operator[](std::size_t axis) { return at_[axis]; }
  /// Coordinate along axis 0, 1 or 2.
  constexpr const std::int32_t& operator[](std::size_t axis) const { return at_[axis]; }

  /// The coordinates so many steps further along each axis.
  [[nodiscard]] constexpr Coord offsetBy(std::int32_t dx, std::int32_t dy, std::int32_t dz) const {
    return {at_[0] + dx, at_[1] + dy, at_[2] + dz};
  }
  [[nodiscard]] constexpr Coord offsetBy(std::int32_t all) const {  ///< the same along all axes
    return offsetBy(all, all, all);
  }

  /// The sum along each axis.
  friend constexpr Coord operator+(const Coord& a, const Coord& b) {
    return a.offsetBy(b[0], b[1], b[2]);
  }
  /// The difference along each axis.
  friend constexpr Coord operator-(const Coord& a, const Coord& b) {
    return a.offsetBy(-b[0], -b[1], -b[2]);
  }
  /// Each coordinate times 2^bits.
  friend constexpr Coord operator<<(const Coord& a, int bits) {
    return {a[0] << bits, a[1] << bits, a[2] << bits};
  }
  /// Each coordinate over 2^bits, rounded down: the cell of that size which holds it.
  friend constexpr Coord operator>>(const Coord& a, int bits) {
    return {a[0] >> bits, a[1] >> bits, a[2] >> bits};
  }
  /// Each coordinate masked.
  friend constexpr Coord operator&(const Coord& a, std::int32_t mask) {
    return {a[0] & mask, a[1] & mask, a[2] & mask};
  }
  /// By x, then y, then z.
  friend constexpr auto operator<=>(const Coord&, const Coord&) = default;
  /// Equal along all axes.
  friend constexpr bool operator==(const Coord&, const Coord&) = default;

 private:
  std::array<std::int32_t, 3> at_{};
};

/// The smaller coordinate along each axis.
[[nodiscard]] constexpr Coord minCoord(const Coord& a, const Coord& b) {
  return {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])};
}

/// The larger coordinate along each axis.
[[nodiscard]] constexpr Coord maxCoord(const Coord& a, const Coord& b) {
  return {std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])};
}

}  // namespace tufa
