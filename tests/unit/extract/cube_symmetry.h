#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "uniform/case_table.h"

namespace tufa::extraction::cells {

/// One of the 48 rotations and reflections of the cube: an order of the axes, and which of them are
/// turned round.
class CubeSymmetry {
 public:
  CubeSymmetry(const std::array<int, 3>& axes, int flips) : axes_(axes), flips_(flips) {}

  [[nodiscard]] int corner(int from) const {
    int to = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = ((from >> (2 - axes_[axis])) & 1) ^ ((flips_ >> axis) & 1);
      to |= bit << (2 - axis);
    }
    return to;
  }
  [[nodiscard]] int edge(int from) const {
    const auto [lower, upper] = uniform::edgeCorners(from);
    return uniform::edgeBetween(corner(lower), corner(upper));
  }
  [[nodiscard]] int face(int from) const {
    std::array<int, 4> corners;
    for (int i = 0; i < 4; ++i) corners[i] = corner(uniform::kFaceCorners[from][i]);
    std::sort(corners.begin(), corners.end());
    for (int face = 0; face < uniform::kFaces; ++face) {
      auto others = uniform::kFaceCorners[face];
      std::sort(others.begin(), others.end());
      if (others == corners) return face;
    }
    return -1;
  }
  [[nodiscard]] uniform::CornerMask mask(uniform::CornerMask from) const {
    unsigned to = 0;
    for (int i = 0; i < 8; ++i) to |= static_cast<unsigned>((from >> i) & 1) << corner(i);
    return static_cast<uniform::CornerMask>(to);
  }
  [[nodiscard]] uniform::FaceBits faces(uniform::FaceBits from) const {
    unsigned to = 0;
    for (int i = 0; i < 6; ++i) to |= static_cast<unsigned>((from >> i) & 1) << face(i);
    return static_cast<uniform::FaceBits>(to);
  }
  /// Whether it turns right-handed into left-handed.
  [[nodiscard]] bool reflects() const {
    bool odd = false;
    for (int i = 0; i < 3; ++i) {
      odd ^= ((flips_ >> i) & 1) != 0;
      for (int j = 0; j < i; ++j) odd ^= axes_[j] > axes_[i];
    }
    return odd;
  }

  [[nodiscard]] static std::vector<CubeSymmetry> all() {
    std::vector<CubeSymmetry> symmetries;
    std::array<int, 3> axes = {0, 1, 2};
    do {
      for (int flips = 0; flips < 8; ++flips) symmetries.emplace_back(axes, flips);
    } while (std::next_permutation(axes.begin(), axes.end()));
    return symmetries;
  }

 private:
  std::array<int, 3> axes_;
  int flips_;
};

}  // namespace tufa::extraction::cells
