// Quadrics and triply periodic surfaces.

#include <tufa/implicit.h>

#include <numbers>

#include "implicit/fields.h"
#include "implicit/formula_field.h"
#include "implicit/spans.h"

namespace tufa::implicit {
namespace {

struct Quadric {
  static constexpr bool kUnitGradient = false;
  QuadricCoefficients c;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    return c[0] * square(x) + c[1] * square(y) + c[2] * square(z) + c[3] * (x * y) +
           c[4] * (y * z) + c[5] * (z * x) + c[6] * x + c[7] * y + c[8] * z + c[9];
  }

  /// That of an ellipsoid; all of space for the others.
  [[nodiscard]] Box extent() const {
    const Affine matrix{{Vec3(c[0], c[3] / 2, c[5] / 2), Vec3(c[3] / 2, c[1], c[4] / 2),
                         Vec3(c[5] / 2, c[4] / 2, c[2])},
                        Vec3(0.0)};
    // Positive definite by its leading minors (Sylvester).
    const double second = c[0] * c[1] - c[3] * c[3] / 4;
    if (!(c[0] > 0 && second > 0 && matrix.determinant() > 0)) return wholeSpace();
    const Affine inverse = matrix.inverse();
    const Vec3 centre = inverse.turn(Vec3(c[6], c[7], c[8])) * -0.5;
    const double depth = -(*this)(centre[0], centre[1], centre[2]);
    Vec3 half(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      half[axis] = std::sqrt(std::max(0.0, depth * inverse.rows[axis][axis])) * (1 + 1e-9);
    }
    return boxAround(centre, half);
  }
  [[nodiscard]] bool insideAlong(const Vec3& p, const Vec3& d, Spans& spans) const {
    const auto product = [&](const Vec3& u, const Vec3& v) {
      return c[0] * u[0] * v[0] + c[1] * u[1] * v[1] + c[2] * u[2] * v[2] +
             (c[3] * (u[0] * v[1] + u[1] * v[0]) + c[4] * (u[1] * v[2] + u[2] * v[1]) +
              c[5] * (u[2] * v[0] + u[0] * v[2])) /
                 2;
    };
    const double a = product(d, d);
    const double b = product(p, d) + Vec3(c[6], c[7], c[8]).dot(d) / 2;
    const double constant = (*this)(p[0], p[1], p[2]);
    // b^2 - a c without what its two products are rounded by (Kahan).
    const double ac = a * constant;
    const double discriminant = std::fma(b, b, -ac) + std::fma(-a, constant, ac);
    appendBelow0(a, b, constant, discriminant, spans);
    return true;
  }
};

/// A lattice's function, which takes values of about -1 to 1, and its derivatives by kx, ky and kz.
template <class T>
struct LatticeAt {
  T value;
  std::array<T, 3> slopes;
};

template <class T>
LatticeAt<T> latticeAt(Lattice lattice, const T& x, const T& y, const T& z) {
  const T sx = sin(x), sy = sin(y), sz = sin(z);
  const T cx = cos(x), cy = cos(y), cz = cos(z);
  switch (lattice) {
    case Lattice::Primitive:
      return {cx + cy + cz, {-sx, -sy, -sz}};
    case Lattice::Diamond:
      return {sx * sy * sz + sx * cy * cz + cx * sy * cz + cx * cy * sz,
              {cx * sy * sz + cx * cy * cz - sx * sy * cz - sx * cy * sz,
               sx * cy * sz - sx * sy * cz + cx * cy * cz - cx * sy * sz,
               sx * sy * cz - sx * cy * sz - cx * sy * sz + cx * cy * cz}};
    case Lattice::Gyroid:
      break;
  }
  return {sx * cy + sy * cz + sz * cx, {cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz}};
}

struct HalfLattice {
  static constexpr bool kUnitGradient = false;
  Lattice lattice;
  double frequency;
  double level;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const auto at = latticeAt<T>(lattice, frequency * x, frequency * y, frequency * z);
    return (at.value - level) / frequency;
  }
  [[nodiscard]] static Box extent() { return wholeSpace(); }
};

/// To first order, the points within half the thickness have |f| < t/2 |gradient f|: an even sheet,
/// which a bound of |f| alone would not give.
struct Sheet {
  static constexpr bool kUnitGradient = false;
  Lattice lattice;
  double frequency;
  Ramp thickness;
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const auto at = latticeAt<T>(lattice, frequency * x, frequency * y, frequency * z);
    const T steepness = norm(at.slopes[0], at.slopes[1], at.slopes[2]);
    return abs(at.value) / frequency - halfThickness(x, y, z) * steepness;
  }
  template <class T>
  T halfThickness(const T& x, const T& y, const T& z) const {
    const Vec3 along = thickness.end - thickness.start;
    const double squared = along.squaredLength();
    const Vec3 step = squared > 0 ? along / squared : Vec3(0.0);
    const T share =
        min(max((x - thickness.start[0]) * step[0] + (y - thickness.start[1]) * step[1] +
                    (z - thickness.start[2]) * step[2],
                0.0),
            1.0);
    return share * ((thickness.to - thickness.from) / 2) + thickness.from / 2;
  }
  [[nodiscard]] static Box extent() { return wholeSpace(); }
};

double frequencyOf(double period) { return 2 * std::numbers::pi / period; }

}  // namespace

FieldPtr makeQuadric(const QuadricCoefficients& coefficients) {
  return fieldOf(Quadric{coefficients});
}

FieldPtr makeLattice(Lattice lattice, double period, double level) {
  return fieldOf(HalfLattice{lattice, frequencyOf(period), level});
}

FieldPtr makeSheet(Lattice lattice, double period, const Ramp& thickness) {
  return fieldOf(Sheet{lattice, frequencyOf(period), thickness});
}

}  // namespace tufa::implicit
