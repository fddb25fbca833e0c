// The bracket: an L-profile of two plates, a triangular rib between them, six through holes.
//
// Its field is the exact Euclidean distance to the solid's boundary. The minimum and maximum of CSG
// would give the right surface, but off it distances that are too short near every convex edge
// (and, inside, near every concave one); a mesh converted to a level set has no such error. So CSG
// gives the sign and a quick lower bound, and the magnitude is the least distance to any boundary
// patch.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "shapes/bracket_parts.h"
#include "shapes/fields.h"

namespace tufa::shapes {
namespace {

using bracket::Cylinder;
using bracket::Face;
using bracket::Parts;
using bracket::Segment;

/// Signed distance to the CSG solid up to a factor: the right sign everywhere, a Lipschitz constant
/// of 1, and so never larger in magnitude than the true distance.
double csgBound(const Vec3& p) {
  using namespace bracket;
  const double sides = std::abs(p.y()) - kHalfDepth;
  const double low = std::max(kLow - p.z(), kBack - p.x());
  const double base = std::max({low, p.x() - kFront, p.z() - kBaseTop});
  const double upright = std::max({low, p.z() - kHigh, p.x() - kUprightFront});
  const double profile = std::max(sides, std::min(base, upright));
  // The rib reaches into both plates, so that the union has no false surface between them.
  const double slope = ((p.x() - kRibEnd) + (p.z() - kBaseTop)) / std::numbers::sqrt2;
  const double rib = std::max({std::abs(p.y()) - kHalfRib, slope, kBack - p.x(), kLow - p.z()});
  double solid = std::min(profile, rib);
  for (const Cylinder& hole : Parts::get().holes) {
    solid = std::max(solid, hole.radius - hole.axisDistance(p));
  }
  return solid;
}

class Bracket final : public DistanceField {
 public:
  [[nodiscard]] double halfExtent() const override { return bracket::kReach; }

  [[nodiscard]] double distance(const Vec3& point) const override {
    const Vec3 p = toShapeFrame(point);
    return std::copysign(Parts::get().boundaryDistance(p), csgBound(p));
  }

  [[nodiscard]] ValueRange range(const Vec3& center, double radius) const override {
    const Vec3 p = toShapeFrame(center);
    const double bound = csgBound(p);
    const double infinity = std::numeric_limits<double>::infinity();
    // The bound may be far too small on its own side of zero, so it only tells where the field is
    // not.
    return bound > radius    ? ValueRange{bound - radius, infinity}
           : bound < -radius ? ValueRange{-infinity, bound + radius}
                             : ValueRange{-infinity, infinity};
  }

  void sample(const BlockLattice& lattice, double band,
              std::array<double, BlockLattice::kSamples>& values) const override {
    const double half = 0.5 * (BlockLattice::kSide - 1) * lattice.voxelSize;
    const Vec3 center = toShapeFrame(lattice.point(0, 0, 0) + Vec3(half));
    const Parts near = Parts::get().near(center, std::numbers::sqrt3 * half);
    std::size_t n = 0;
    for (int x = 0; x < BlockLattice::kSide; ++x) {
      for (int y = 0; y < BlockLattice::kSide; ++y) {
        for (int z = 0; z < BlockLattice::kSide; ++z) {
          const Vec3 p = toShapeFrame(lattice.point(x, y, z));
          const double bound = csgBound(p);
          const bool far = std::abs(bound) >= band;
          values[n++] = far ? bound : std::copysign(near.boundaryDistance(p), bound);
        }
      }
    }
  }
};

}  // namespace

std::unique_ptr<DistanceField> makeBracket() { return std::make_unique<Bracket>(); }

std::vector<Position> bracketCreasePoints(double spacing) {
  std::vector<Position> points;
  for (const Segment& edge : Parts::get().edges) appendSegment(edge.a, edge.b, spacing, points);
  for (const Cylinder& hole : Parts::get().holes) {
    const Vec3 u = Vec3(hole.axis.z(), hole.axis.x(), hole.axis.y());
    const Vec3 v = hole.axis.cross(u);
    const double length = 2 * std::numbers::pi * hole.radius;
    const int steps = std::max(3, static_cast<int>(std::ceil(length / spacing)));
    for (int n = 0; n < steps; ++n) {
      const double angle = 2 * std::numbers::pi * n / steps;
      const Vec3 rim = hole.start + (u * std::cos(angle) + v * std::sin(angle)) * hole.radius;
      for (const Vec3& end : {rim, rim + hole.axis * hole.height}) {
        const Vec3 p = toWorldFrame(end);
        points.emplace_back(p.x(), p.y(), p.z());
      }
    }
  }
  return points;
}

}  // namespace tufa::shapes
