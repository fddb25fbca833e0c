#pragma once

#include <tufa/coord.h>
#include <tufa/mesh.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tufa {

/// A vector or point in double precision. Sums run from x to z, so that results are the same bytes
/// everywhere.
class Vec3 {
 public:
  Vec3() {}  // NOLINT(modernize-use-equals-default): "= default" would zero every array
  constexpr explicit Vec3(double all) : at_{all, all, all} {}
  constexpr Vec3(double x, double y, double z) : at_{x, y, z} {}
  Vec3(const Position& p) : at_{p.x, p.y, p.z} {}
  explicit Vec3(const Normal& n) : at_{n.x, n.y, n.z} {}
  explicit Vec3(const Coord& c)
      : at_{static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])} {}

  operator Position() const { return {at_[0], at_[1], at_[2]}; }
  explicit operator Normal() const {
    return {static_cast<float>(at_[0]), static_cast<float>(at_[1]), static_cast<float>(at_[2])};
  }

  double& operator[](std::size_t axis) { return at_[axis]; }
  const double& operator[](std::size_t axis) const { return at_[axis]; }

  Vec3& operator+=(const Vec3& b) {
    for (int i = 0; i < 3; ++i) at_[i] += b.at_[i];
    return *this;
  }
  Vec3& operator-=(const Vec3& b) {
    for (int i = 0; i < 3; ++i) at_[i] -= b.at_[i];
    return *this;
  }
  Vec3& operator*=(double factor) {
    for (double& x : at_) x *= factor;
    return *this;
  }
  Vec3& operator/=(double divisor) {
    for (double& x : at_) x /= divisor;
    return *this;
  }
  friend Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
  friend Vec3 operator*(Vec3 a, double factor) { return a *= factor; }
  friend Vec3 operator*(double factor, Vec3 a) { return a *= factor; }
  friend Vec3 operator/(Vec3 a, double divisor) { return a /= divisor; }
  friend Vec3 operator-(const Vec3& a) { return {-a[0], -a[1], -a[2]}; }
  friend bool operator==(const Vec3& a, const Vec3& b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
  }

  /// By x, then y, then z.
  friend bool operator<(const Vec3& a, const Vec3& b) {
    for (int i = 0; i < 2; ++i) {
      if (a[i] != b[i]) return a[i] < b[i];
    }
    return a[2] < b[2];
  }

  [[nodiscard]] double dot(const Vec3& b) const {
    return at_[0] * b.at_[0] + at_[1] * b.at_[1] + at_[2] * b.at_[2];
  }
  [[nodiscard]] Vec3 cross(const Vec3& b) const {
    return {at_[1] * b.at_[2] - at_[2] * b.at_[1], at_[2] * b.at_[0] - at_[0] * b.at_[2],
            at_[0] * b.at_[1] - at_[1] * b.at_[0]};
  }
  [[nodiscard]] double squaredLength() const { return dot(*this); }
  [[nodiscard]] double length() const { return std::sqrt(squaredLength()); }
  [[nodiscard]] bool isFinite() const {
    return std::isfinite(at_[0]) && std::isfinite(at_[1]) && std::isfinite(at_[2]);
  }
  /// Scales to length 1. Leaves a vector of length `least` or less as it is, and returns false.
  bool normalize(double least = 1e-7) {
    const double was = length();
    if (!(was > least)) return false;
    *this *= 1 / was;
    return true;
  }
  /// Scaled to length 1, or (1, 0, 0) if the length is 0.
  [[nodiscard]] Vec3 unitOrX() const {
    const double was = length();
    return was > 0 ? *this / was : Vec3(1, 0, 0);
  }

 private:
  double at_[3];
};

/// The smaller coordinate along each axis.
[[nodiscard]] inline Vec3 minVec3(const Vec3& a, const Vec3& b) {
  return {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])};
}

/// The larger coordinate along each axis.
[[nodiscard]] inline Vec3 maxVec3(const Vec3& a, const Vec3& b) {
  return {std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])};
}

/// The lattice point nearest below, along each axis.
[[nodiscard]] inline Coord floorCoord(const Vec3& p) {
  return {static_cast<std::int32_t>(std::floor(p[0])), static_cast<std::int32_t>(std::floor(p[1])),
          static_cast<std::int32_t>(std::floor(p[2]))};
}

}  // namespace tufa
