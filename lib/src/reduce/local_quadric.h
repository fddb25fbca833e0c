#pragma once

#include "reduce/triangles.h"

namespace tufa::reduce {

/// The sum of squared distances to planes, weighted by area (Garland and Heckbert 1997), as seen
/// from a place that is kept elsewhere. Beside base::Quadric it takes a third of the memory, and in
/// single precision nothing cancels far from the origin.
struct LocalQuadric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  ///< the symmetric matrix
  float bx = 0, by = 0, bz = 0, c = 0;                   ///< linear part and constant
  float weight = 0;                                      ///< sum of the areas

  /// Adds a plane with this unit normal through the place it is seen from.
  void addPlane(Vec3f n, float area) {
    xx += area * n.x * n.x, xy += area * n.x * n.y, xz += area * n.x * n.z;
    yy += area * n.y * n.y, yz += area * n.y * n.z, zz += area * n.z * n.z;
    weight += area;
  }

  /// Sees it from a place that is d further on.
  void moveBy(Vec3f d) {
    const float ax = xx * d.x + xy * d.y + xz * d.z, ay = xy * d.x + yy * d.y + yz * d.z,
                az = xz * d.x + yz * d.y + zz * d.z;
    c += 2 * (bx * d.x + by * d.y + bz * d.z) + ax * d.x + ay * d.y + az * d.z;
    bx += ax, by += ay, bz += az;
  }

  /// Both seen from the same place.
  LocalQuadric& operator+=(const LocalQuadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    bx += o.bx, by += o.by, bz += o.bz, c += o.c, weight += o.weight;
    return *this;
  }

  /// Of the matrix.
  [[nodiscard]] float determinant() const {
    return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  }
  /// The sum of its principal minors of two rows.
  [[nodiscard]] float minors() const {
    return xx * yy - xy * xy + yy * zz - yz * yz + zz * xx - xz * xz;
  }

  /// Where it is least, by LDLT. A thousandth of the trace keeps what the planes leave almost free
  /// near the place it is seen from.
  [[nodiscard]] Vec3f minimum() const {
    const float regular = 1e-3f * (xx + yy + zz) + 1e-20f;
    const float d0 = xx + regular, l1 = xy / d0, l2 = xz / d0;
    const float d1 = yy + regular - l1 * xy, m = yz - l1 * xz, l3 = m / d1;
    const float d2 = zz + regular - l2 * xz - l3 * m;
    const float y0 = -bx, y1 = -by - l1 * y0, y2 = -bz - l2 * y0 - l3 * y1;
    const float z = y2 / d2, y = y1 / d1 - l3 * z, x = y0 / d0 - l1 * y - l2 * z;
    return {x, y, z};
  }

  /// The same among places in the plane with two unit directions at a right angle.
  [[nodiscard]] Vec3f minimumAlong(Vec3f u, Vec3f v) const {
    const auto times = [&](Vec3f d) {
      return Vec3f{xx * d.x + xy * d.y + xz * d.z, xy * d.x + yy * d.y + yz * d.z,
                   xz * d.x + yz * d.y + zz * d.z};
    };
    const Vec3f b{bx, by, bz}, qu = times(u), qv = times(v);
    const float regular = 1e-3f * (dot(u, qu) + dot(v, qv)) + 1e-20f;
    const float d0 = dot(u, qu) + regular, l = dot(u, qv) / d0;
    const float d1 = dot(v, qv) + regular - l * dot(u, qv);
    const float y = (-dot(v, b) + l * dot(u, b)) / d1, x = -dot(u, b) / d0 - l * y;
    return u * x + v * y;
  }

  /// The sum at a place d further on.
  [[nodiscard]] float at(Vec3f d) const {
    return c + 2 * (bx * d.x + by * d.y + bz * d.z) + d.x * (xx * d.x + 2 * (xy * d.y + xz * d.z)) +
           d.y * (yy * d.y + 2 * yz * d.z) + zz * d.z * d.z;
  }
};

}  // namespace tufa::reduce
