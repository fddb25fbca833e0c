#include "base/lattice_range.h"

#include <tufa/error.h>

#include <algorithm>
#include <cmath>

#include "base/number_text.h"

namespace tufa::base {
namespace {

constexpr double kShortest = 1e-25, kLongest = 1e25;

/// The least share of the longest step that a voxel may be high: flatter ones have no inverse in
/// double precision that is of use.
constexpr double kFlattest = 1e-9;

/// The most voxels between the world's origin and that of the lattice.
constexpr double kFarthest = 1099511627776.0;  // 2^40

/// OpenVDB makes no transform with a determinant below 3e-15.
constexpr double kShortestMade = 1.5e-5;

/// Vec3::length() squares, which has half the range.
double lengthOf(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

}  // namespace

std::string whyOutOfRange(const Lattice& lattice) {
  const auto& [x, y, z] = lattice.steps;
  if (!lattice.origin.isFinite() || !x.isFinite() || !y.isFinite() || !z.isFinite()) {
    return "its transform is not finite; give it another";
  }
  const double shortest = std::min({lengthOf(x), lengthOf(y), lengthOf(z)});
  const double longest = std::max({lengthOf(x), lengthOf(y), lengthOf(z)});
  for (const double length : {shortest, longest}) {
    if (length >= kShortest && length <= kLongest) continue;
    return "its voxels are " + numberText(length) + " world units long, not " +
           numberText(kShortest) + " to " + numberText(kLongest) + "; scale its transform";
  }
  // In units of the longest step, where no product overflows or vanishes.
  const Vec3 a = x / longest, b = y / longest, c = z / longest;
  const double volume = std::abs(a.dot(b.cross(c)));
  const double face = std::max({a.cross(b).length(), b.cross(c).length(), c.cross(a).length()});
  if (!(volume >= kFlattest * face)) {
    return "its voxels are flat: less than " + numberText(kFlattest) +
           " as high as they are long; give it another transform";
  }
  const double distance = lengthOf(lattice.origin) / shortest;
  if (distance > kFarthest) {
    return "its index origin lies " + numberText(distance) +
           " voxels from the world's, more than " + numberText(kFarthest) + "; move it nearer";
  }
  return {};
}

void requireVoxelSize(double voxelSize) {
  if (voxelSize >= kShortestMade && voxelSize <= kLongest) return;
  throw Error(ErrorCode::InvalidArgument, "voxel size must be from " + numberText(kShortestMade) +
                                              " to " + numberText(kLongest) + ", not " +
                                              numberText(voxelSize));
}

void requireHalfWidth(double halfWidth) {
  if (isHalfWidth(halfWidth)) return;
  throw Error(ErrorCode::InvalidArgument, "half width must be from 1 to " +
                                              numberText(kMostHalfWidth) + " voxels, not " +
                                              numberText(halfWidth));
}

}  // namespace tufa::base
