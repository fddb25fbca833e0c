#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "reduce/box3f.h"

namespace tufa::reduce {

/// Sixteen boxes side by side, so that another one is compared with all of them at once. They hold
/// nothing at first.
class BoxGroup {
 public:
  static constexpr std::size_t kSize = 16;

  BoxGroup() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::fill_n(lower_[axis], kSize, Box3f::kMost);
      std::fill_n(upper_[axis], kSize, -Box3f::kMost);
    }
  }

  [[nodiscard]] Box3f at(std::size_t i) const {
    Box3f box;
    box.lower = {lower_[0][i], lower_[1][i], lower_[2][i]};
    box.upper = {upper_[0][i], upper_[1][i], upper_[2][i]};
    return box;
  }
  void set(std::size_t i, const Box3f& box) {
    for (int axis = 0; axis < 3; ++axis) {
      lower_[axis][i] = box.lower[axis];
      upper_[axis][i] = box.upper[axis];
    }
  }
  /// Makes a box hold another one, too.
  void add(std::size_t i, const Box3f& box) {
    Box3f both = at(i);
    both.add(box);
    set(i, both);
  }

  /// Calls f(i) for all that meet `box`, in order, until f returns true; returns whether it did.
  template <class F>
  bool any(const Box3f& box, F&& f) const {
    // The compiler makes vectors of this loop; a byte for each box.
    std::array<std::uint8_t, kSize> meets;
    for (std::size_t i = 0; i < kSize; ++i) {
      const int x = (lower_[0][i] <= box.upper.x) & (upper_[0][i] >= box.lower.x);
      const int y = (lower_[1][i] <= box.upper.y) & (upper_[1][i] >= box.lower.y);
      const int z = (lower_[2][i] <= box.upper.z) & (upper_[2][i] >= box.lower.z);
      meets[i] = static_cast<std::uint8_t>(x & y & z);
    }
    const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(meets);
    if ((halves[0] | halves[1]) == 0) return false;
    for (std::size_t i = 0; i < kSize; ++i) {
      if (meets[i] != 0 && f(i)) return true;
    }
    return false;
  }

 private:
  float lower_[3][kSize], upper_[3][kSize];
};

}  // namespace tufa::reduce
