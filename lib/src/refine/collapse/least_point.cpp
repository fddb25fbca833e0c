#include "refine/collapse/least_point.h"

namespace tufa::refine {

namespace {

// Added to the diagonal, as a share of its sum: a weak pull to the origin, which decides only in
// directions that the planes leave free, and keeps the matrix positive definite (Tikhonov).
constexpr double kFree = 1e-3;

}  // namespace

Vec3 leastPoint(const base::Quadric& planes) {
  const auto& a = planes.a;
  const Vec3& b = planes.b;
  const double free = kFree * (a[0] + a[3] + a[5]);
  if (!(free > 0)) return Vec3(0.0);
  const double xx = a[0] + free, yy = a[3] + free, zz = a[5] + free;
  // The adjugate of a symmetric matrix that is positive definite.
  const double c00 = yy * zz - a[4] * a[4], c01 = a[2] * a[4] - a[1] * zz,
               c02 = a[1] * a[4] - a[2] * yy;
  const double c11 = xx * zz - a[2] * a[2], c12 = a[1] * a[2] - xx * a[4],
               c22 = xx * yy - a[1] * a[1];
  const double determinant = xx * c00 + a[1] * c01 + a[2] * c02;
  return Vec3(c00 * b[0] + c01 * b[1] + c02 * b[2], c01 * b[0] + c11 * b[1] + c12 * b[2],
              c02 * b[0] + c12 * b[1] + c22 * b[2]) /
         determinant;
}

}  // namespace tufa::refine
