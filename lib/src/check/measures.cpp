#include "check/measures.h"
#include "base/vec3.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "check/sum_ranges.h"

namespace tufa::checks {
namespace {

/// Running totals over faces.
struct Totals {
  double twiceArea = 0;
  double sixVolumes = 0;
  double smallestAngle = std::numbers::pi;
  std::size_t sharpFaces = 0;

  Totals& operator+=(const Totals& other) {
    twiceArea += other.twiceArea;
    sixVolumes += other.sixVolumes;
    smallestAngle = std::min(smallestAngle, other.smallestAngle);
    sharpFaces += other.sharpFaces;
    return *this;
  }
};

/// The angle between two vectors, in radians. The arc tangent keeps its digits where the arc cosine
/// loses them, at angles near 0.
double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).length(), a.dot(b));
}

void addFace(const Vec3& a, const Vec3& b, const Vec3& c, Totals& totals) {
  constexpr double kSharp = 10 * std::numbers::pi / 180;
  totals.twiceArea += (b - a).cross(c - a).length();
  totals.sixVolumes += a.dot(b.cross(c));
  const double smallest = std::min(
      {angleBetween(b - a, c - a), angleBetween(c - b, a - b), angleBetween(a - c, b - c)});
  totals.smallestAngle = std::min(totals.smallestAngle, smallest);
  totals.sharpFaces += smallest < kSharp ? 1 : 0;
}

}  // namespace

void measure(const Faces& faces, base::Job& job, CheckReport& report) {
  const std::size_t counted = faces.proper.size() + faces.collapsedCount;
  if (counted == 0) return;
  // Volumes are taken about a vertex of the mesh: far from the world's origin rounding would spoil
  // them.
  const Vec3 origin =
      faces.proper.empty() ? Vec3(0) : Vec3(faces.positions[faces.proper[0].vertices[0]]);
  const auto corner = [&](VertexIndex v) { return Vec3(faces.positions[v]) - origin; };
  const auto totals =
      sumRanges<Totals>(job, faces.proper.size(), 4096, [&](std::size_t begin, std::size_t end) {
        Totals part;
        for (std::size_t f = begin; f < end; ++f) {
          const auto& v = faces.proper[f].vertices;
          addFace(corner(v[0]), corner(v[1]), corner(v[2]), part);
        }
        return part;
      });
  report.area = totals.twiceArea / 2;
  report.volume = totals.sixVolumes / 6;
  // A collapsed face has a corner of 0 degrees.
  const bool collapsed = faces.collapsedCount > 0;
  report.smallestAngleDegrees = collapsed ? 0 : totals.smallestAngle * 180 / std::numbers::pi;
  report.shareUnder10Degrees =
      static_cast<double>(totals.sharpFaces + faces.collapsedCount) / static_cast<double>(counted);
}

}  // namespace tufa::checks
