#pragma once

#include <tufa/implicit.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/vec3.h"
#include "implicit/interval.h"

// What makes fields. Arguments have been checked: radii are above 0, axes have a length.

namespace tufa::implicit {

using FieldPtr = std::shared_ptr<const Field>;

// Distance surfaces: exact signed distances.
[[nodiscard]] FieldPtr makeSphere(const Vec3& centre, double radius);
/// A segment with its ends rounded off.
[[nodiscard]] FieldPtr makeSegment(const Vec3& a, const Vec3& b, double radius);
[[nodiscard]] FieldPtr makePolyline(const std::vector<Vec3>& points, double radius);
/// Around a circle: a torus.
[[nodiscard]] FieldPtr makeCircle(const Vec3& centre, const Vec3& normal, double circle,
                                  double radius);
/// With its edges rounded off to `radius`, which may be 0; `half` includes it.
[[nodiscard]] FieldPtr makeBox(const Vec3& centre, const Vec3& half, double radius);
/// The half space on the side of `point` that the normal does not point to.
[[nodiscard]] FieldPtr makePlane(const Vec3& point, const Vec3& normal);
/// With flat ends.
[[nodiscard]] FieldPtr makeCylinder(const Vec3& a, const Vec3& b, double radius);

/// Coefficients of x², y², z², xy, yz, zx, x, y, z and 1.
using QuadricCoefficients = std::array<double, 10>;
[[nodiscard]] FieldPtr makeQuadric(const QuadricCoefficients& coefficients);

/// Surfaces of period `period` that divide space in two.
enum class Lattice { Gyroid, Primitive, Diamond };

/// A number that changes evenly from one point to another, and not beyond them.
struct Ramp {
  double from = 0;
  double to = 0;
  Vec3 start{0.0};
  Vec3 end{0.0};
};

/// The side where the lattice's function is below `level`, from -1 to 1.
[[nodiscard]] FieldPtr makeLattice(Lattice lattice, double period, double level);
/// The sheet around the surface.
[[nodiscard]] FieldPtr makeSheet(Lattice lattice, double period, const Ramp& thickness);

enum class Operation { Union, Intersection };

/// The least or greatest of several fields, at least one; `radius` above 0 blends them. Those with
/// many parts, or a deep tree of them, are cheap where few of them count.
[[nodiscard]] FieldPtr combine(Operation operation, std::vector<FieldPtr> parts, double radius);
[[nodiscard]] FieldPtr makeComplement(FieldPtr part);
/// Everything, or nothing.
[[nodiscard]] FieldPtr makeUniform(double value);
/// The surface moved outward by so much of the field's value.
[[nodiscard]] FieldPtr makeOffset(FieldPtr part, double by);
/// What lies nearer to the surface than half the thickness, in the field's value.
[[nodiscard]] FieldPtr makeShell(FieldPtr part, double thickness);

/// x -> rows x + shift.
struct Affine {
  std::array<Vec3, 3> rows{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  Vec3 shift{0.0};
  [[nodiscard]] Vec3 turn(const Vec3& v) const {
    return {rows[0].dot(v), rows[1].dot(v), rows[2].dot(v)};
  }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return turn(p) + shift; }
  [[nodiscard]] double determinant() const { return rows[0].dot(rows[1].cross(rows[2])); }
  /// This one, then another one.
  [[nodiscard]] Affine then(const Affine& next) const;
  [[nodiscard]] Affine inverse() const;
};

/// The solid moved by a map that can be inverted. Values are scaled with it, so that distances stay
/// what they are where the map keeps shapes.
[[nodiscard]] FieldPtr transformed(FieldPtr part, const Affine& map);

/// `counts` copies along the axes, `steps` apart, the first one where the part is. The part must
/// be no longer than the step along each axis of several copies.
[[nodiscard]] FieldPtr repeated(FieldPtr part, const Vec3& steps,
                                const std::array<std::int64_t, 3>& counts);

}  // namespace tufa::implicit
