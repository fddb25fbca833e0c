#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace tufa::extraction::cells {

/// The trilinear interpolant of a cell, by its definition. Corner (dx, dy, dz) is number
/// dx * 4 + dy * 2 + dz.
class TrilinearCell {
 public:
  explicit TrilinearCell(const std::array<float, 8>& values) {
    for (int i = 0; i < 8; ++i) values_[i] = static_cast<double>(values[i]);
    for (int i = 0; i < 8; ++i) {
      // Coefficient of the product of the coordinates in i: by inclusion and exclusion.
      for (int j = 0; j < 8; ++j) {
        if ((j & i) != j) continue;
        const int fewer = ((i ^ j) & 1) + ((i ^ j) >> 1 & 1) + ((i ^ j) >> 2 & 1);
        terms_[i] += fewer % 2 == 0 ? values_[j] : -values_[j];
      }
    }
  }

  [[nodiscard]] double at(double x, double y, double z) const {
    return terms_[0] + terms_[4] * x + terms_[2] * y + terms_[1] * z + terms_[6] * x * y +
           terms_[5] * x * z + terms_[3] * y * z + terms_[7] * x * y * z;
  }

  /// The Euler characteristic of the part of the cell where `sign` * field < 0, by stratified Morse
  /// theory: each critical point of the cell, its faces and corners adds what its lower link lacks.
  /// `certain` is cleared where a decision hangs on rounding.
  [[nodiscard]] int eulerOfSide(int sign, bool& certain) const {
    int euler = 0;
    for (int corner = 0; corner < 8; ++corner) {
      bool least = sign * values_[corner] < 0;
      for (const int step : {1, 2, 4}) {
        least = least && sign * (values_[corner ^ step] - values_[corner]) > 0;
      }
      euler += least ? 1 : 0;
    }
    for (int face = 0; face < 6; ++face) euler += ofFace(face, sign, certain);
    return euler + ofInside(sign, certain);
  }

  /// The components of either side on a lattice of n^3 points, counted with steps along the axes
  /// and with diagonal steps; both are the same where the lattice is fine enough.
  [[nodiscard]] std::array<int, 2> componentsOnLattice(int n, bool diagonal) const {
    std::vector<signed char> side(static_cast<std::size_t>(n * n * n));
    for (int i = 0; i < n * n * n; ++i) {
      const double step = 1.0 / (n - 1);
      side[i] = at(i / n / n * step, i / n % n * step, i % n * step) < 0 ? 0 : 1;
    }
    std::array<int, 2> count{};
    std::vector<int> stack;
    for (int seed = 0; seed < n * n * n; ++seed) {
      const int own = side[seed];
      if (own < 0) continue;
      ++count[own];
      stack.push_back(seed);
      side[seed] = -1;
      while (!stack.empty()) {
        const int from = stack.back();
        stack.pop_back();
        for (int d = 0; d < 27; ++d) {
          const int dx = d / 9 - 1, dy = d / 3 % 3 - 1, dz = d % 3 - 1;
          if (!diagonal && std::abs(dx) + std::abs(dy) + std::abs(dz) != 1) continue;
          const int x = from / n / n + dx, y = from / n % n + dy, z = from % n + dz;
          if (x < 0 || y < 0 || z < 0 || x >= n || y >= n || z >= n) continue;
          const int to = (x * n + y) * n + z;
          if (side[to] != own) continue;
          side[to] = -1;
          stack.push_back(to);
        }
      }
    }
    return count;
  }

 private:
  static constexpr double kClose = 1e-9;

  static bool decided(double value, bool& certain) {
    certain = certain && std::abs(value) > kClose;
    return value > 0;
  }

  // The saddle of a face adds -1 if it is on the side and the field rises from it into the cell.
  [[nodiscard]] int ofFace(int face, int sign, bool& certain) const {
    const int axis = face / 2, normal = 4 >> axis;
    const int u = 4 >> ((axis + 1) % 3), v = 4 >> ((axis + 2) % 3);
    const int base = (face & 1) != 0 ? normal : 0;
    const double a = values_[base], b = values_[base | u], c = values_[base | v],
                 d = values_[base | u | v];
    const double twist = a - b - c + d;
    if (std::abs(twist) < kClose) return 0;
    const double x = (a - c) / twist, y = (a - b) / twist;  // along u, along v
    if (!decided(x, certain) || !decided(1 - x, certain)) return 0;
    if (!decided(y, certain) || !decided(1 - y, certain)) return 0;
    if (decided(sign * (a * d - b * c) / twist, certain)) return 0;
    const auto opposite = [&](int corner) { return values_[(base ^ normal) | corner]; };
    const double beyond = opposite(0) * (1 - x) * (1 - y) + opposite(u) * x * (1 - y) +
                          opposite(v) * (1 - x) * y + opposite(u | v) * x * y;
    return decided(sign * (beyond - (a * d - b * c) / twist), certain) ? -1 : 0;
  }

  // The critical points inside: -1 for each of index 1, +1 for each of index 2.
  [[nodiscard]] int ofInside(int sign, bool& certain) const {
    const double cube = terms_[7];
    if (std::abs(cube) < kClose) {
      certain = false;
      return 0;
    }
    // Moved to where the mixed terms vanish, y z = p, x z = q, x y = r.
    const double p = (terms_[6] * terms_[5] / cube - terms_[4]) / cube;
    const double q = (terms_[6] * terms_[3] / cube - terms_[2]) / cube;
    const double r = (terms_[5] * terms_[3] / cube - terms_[1]) / cube;
    if (!(p * q * r > 0)) return 0;
    int sum = 0;
    for (const int branch : {-1, 1}) {
      const double product = branch * std::sqrt(p * q * r);
      const double x = product / p - terms_[3] / cube, y = product / q - terms_[5] / cube,
                   z = product / r - terms_[6] / cube;
      bool inside = true;
      for (const double c : {x, y, z}) {
        inside = inside && decided(c, certain) && decided(1 - c, certain);
      }
      if (!inside || decided(sign * at(x, y, z), certain)) continue;
      // The Hessian's trace is 0 and its determinant 2 cube^3 product: above 0 if two of its
      // eigenvalues are below.
      sum += sign * cube * product > 0 ? 1 : -1;
    }
    return sum;
  }

  std::array<double, 8> values_{};
  std::array<double, 8> terms_{};
};

}  // namespace tufa::extraction::cells
