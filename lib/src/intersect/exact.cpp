#include "intersect/exact.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tufa::intersect {
namespace {

constexpr double kHalfUlp = std::numeric_limits<double>::epsilon() / 2;

// A sum of doubles without rounding, as an expansion (Shewchuk 1997): components that do not
// overlap, least first. Each added number adds at most one component. The determinants below add at
// most 96 numbers: four determinants of six products of three, each product four numbers.
class ExactSum {
 public:
  void add(double term) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = term + parts_[i];
      const double back = sum - term;
      const double lost = (term - (sum - back)) + (parts_[i] - back);
      if (lost != 0) parts_[kept++] = lost;
      term = sum;
    }
    if (term != 0) parts_[kept++] = term;
    size_ = kept;
  }
  // A product and its rounding error, which fma gives exactly.
  void addProduct(double x, double y) {
    const double high = x * y;
    add(std::fma(x, y, -high));
    add(high);
  }
  void addProduct(double x, double y, double z) {
    const double high = x * y;
    addProduct(std::fma(x, y, -high), z);
    addProduct(high, z);
  }
  // Components do not overlap, so the last outweighs all others together.
  [[nodiscard]] int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, 96> parts_;
  std::size_t size_ = 0;
};

int signOf(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

// Adds sign * det(a, b, c), sign being 1 or -1.
void addDeterminant(ExactSum& sum, double sign, const Position& a, const Position& b,
                    const Position& c) {
  sum.addProduct(sign * a.x, b.y, c.z);
  sum.addProduct(sign * a.y, b.z, c.x);
  sum.addProduct(sign * a.z, b.x, c.y);
  sum.addProduct(-sign * a.x, b.z, c.y);
  sum.addProduct(-sign * a.y, b.x, c.z);
  sum.addProduct(-sign * a.z, b.y, c.x);
}

int exactOrientation(const Position& a, const Position& b, const Position& c, const Position& d) {
  ExactSum sum;
  addDeterminant(sum, 1, b, c, d);
  addDeterminant(sum, -1, a, c, d);
  addDeterminant(sum, 1, a, b, d);
  addDeterminant(sum, -1, a, b, c);
  return sum.sign();
}

}  // namespace

int orientation(const Position& a, const Position& b, const Position& c, const Position& d) {
  const double bx = b.x - a.x, by = b.y - a.y, bz = b.z - a.z;
  const double cx = c.x - a.x, cy = c.y - a.y, cz = c.z - a.z;
  const double dx = d.x - a.x, dy = d.y - a.y, dz = d.z - a.z;
  const double yz = cy * dz, zy = cz * dy, zx = cz * dx, xz = cx * dz, xy = cx * dy, yx = cy * dx;
  const double determinant = bx * (yz - zy) + by * (zx - xz) + bz * (xy - yx);
  const double size = std::abs(bx) * (std::abs(yz) + std::abs(zy)) +
                      std::abs(by) * (std::abs(zx) + std::abs(xz)) +
                      std::abs(bz) * (std::abs(xy) + std::abs(yx));
  // Shewchuk's bound on the error is 7 half ulps of `size` and a little; nearly all calls end here.
  if (std::abs(determinant) > 8 * kHalfUlp * size) return signOf(determinant);
  // A difference is zero only if the numbers are equal. Four points in a plane across an axis are
  // common on mechanical parts and need no exact sum.
  if ((bx == 0 && cx == 0 && dx == 0) || (by == 0 && cy == 0 && dy == 0) ||
      (bz == 0 && cz == 0 && dz == 0)) {
    return 0;
  }
  return exactOrientation(a, b, c, d);
}

int orientationAcross(int axis, const Position& a, const Position& b, const Position& c) {
  const auto flat = [axis](const Position& p) -> std::array<double, 2> {
    return axis == 0   ? std::array{p.y, p.z}
           : axis == 1 ? std::array{p.z, p.x}
                       : std::array{p.x, p.y};
  };
  const auto [ax, ay] = flat(a);
  const auto [bx, by] = flat(b);
  const auto [cx, cy] = flat(c);
  const double left = (bx - ax) * (cy - ay), right = (by - ay) * (cx - ax);
  // The bound is 3 half ulps and a little.
  if (std::abs(left - right) > 4 * kHalfUlp * (std::abs(left) + std::abs(right))) {
    return signOf(left - right);
  }
  ExactSum sum;
  sum.addProduct(bx, cy);
  sum.addProduct(-by, cx);
  sum.addProduct(-ax, cy);
  sum.addProduct(ay, cx);
  sum.addProduct(ax, by);
  sum.addProduct(-ay, bx);
  return sum.sign();
}

}  // namespace tufa::intersect
