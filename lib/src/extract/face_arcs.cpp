#include "extract/face_arcs.h"

#include <algorithm>
#include <cmath>

namespace tufa::extraction {
namespace {

// Sharp points keep this far from the edges of their face, in voxels, as crossings do from the ends
// of theirs, and from the crossings.
constexpr double kMargin = 1e-3;
// Sine of the angle between lines that are taken for parallel.
constexpr double kLeastSine = 0.1;

// An arc with its sharp point, if it has one.
struct Path {
  std::array<FacePoint, 3> points{};
  int count = 0;

  void add(const FacePoint& point) { points[count++] = point; }
};

double cross(const FacePoint& a, const FacePoint& b) { return a[0] * b[1] - a[1] * b[0]; }

FacePoint step(const FacePoint& from, const FacePoint& to) {
  return {to[0] - from[0], to[1] - from[1]};
}

// On which side of the line from a to b.
double side(const FacePoint& a, const FacePoint& b, const FacePoint& point) {
  return cross(step(a, b), step(a, point));
}

bool segmentsIntersect(const FacePoint& a, const FacePoint& b, const FacePoint& c,
                       const FacePoint& d) {
  return (side(a, b, c) > 0) != (side(a, b, d) > 0) && (side(c, d, a) > 0) != (side(c, d, b) > 0);
}

bool pathsIntersect(const Path& a, const Path& b) {
  for (int i = 1; i < a.count; ++i) {
    for (int k = 1; k < b.count; ++k) {
      if (segmentsIntersect(a.points[i - 1], a.points[i], b.points[k - 1], b.points[k])) {
        return true;
      }
    }
  }
  return false;
}

bool arcsIntersect(const FaceArcs& arcs, const std::array<FaceCrossing, 4>& crossings,
                   double leastCosine) {
  std::array<Path, 2> paths;
  for (int i = 0; i < 2; ++i) {
    const FaceCrossing& from = crossings[arcs.arcs[i].from];
    const FaceCrossing& to = crossings[arcs.arcs[i].to];
    paths[i].add(from.at);
    if (const auto point = sharpPoint(from, to, leastCosine)) paths[i].add(*point);
    paths[i].add(to.at);
  }
  return pathsIntersect(paths[0], paths[1]);
}

}  // namespace

FaceArcs arcsOf(uniform::CornerMask mask, int face, bool joined) {
  FaceArcs all;
  const auto& corners = uniform::kFaceCorners[face];
  const auto isIn = [&](int corner) { return uniform::isInside(mask, corners[corner % 4]); };
  const bool backward = uniform::isAmbiguous(mask, face) && joined;
  for (int i = 0; i < 4; ++i) {
    if (isIn(i) || !isIn(i + 1)) continue;
    int leave = backward ? i + 3 : i + 1;
    while (!isIn(leave) || isIn(leave + 1)) ++leave;
    all.arcs[all.count++] = {i, leave % 4};
  }
  const auto hasFirst = [](const FaceArc& arc) { return arc.from == 0 || arc.to == 0; };
  if (all.count == 2 && !hasFirst(all.arcs[0])) std::swap(all.arcs[0], all.arcs[1]);
  return all;
}

bool isSharp(const FaceCrossing& from, const FaceCrossing& to, double leastCosine) {
  const Normal& a = from.normal;
  const Normal& b = to.normal;
  return static_cast<double>(a.x * b.x + a.y * b.y + a.z * b.z) < leastCosine;
}

bool isInFace(const FacePoint& point) {
  return std::all_of(point.begin(), point.end(),
                     [](double x) { return x >= kMargin && x <= 1 - kMargin; });
}

std::optional<FacePoint> sharpPoint(const FaceCrossing& from, const FaceCrossing& to,
                                    double leastCosine) {
  if (!isSharp(from, to, leastCosine)) return std::nullopt;
  const double determinant = cross(from.plane, to.plane);
  const double lengths = std::hypot(from.plane[0], from.plane[1]) *  //
                         std::hypot(to.plane[0], to.plane[1]);
  if (!(std::abs(determinant) > kLeastSine * lengths)) return std::nullopt;
  const double first = from.plane[0] * from.at[0] + from.plane[1] * from.at[1];
  const double second = to.plane[0] * to.at[0] + to.plane[1] * to.at[1];
  const FacePoint point = {(first * to.plane[1] - second * from.plane[1]) / determinant,
                           (second * from.plane[0] - first * to.plane[0]) / determinant};
  if (!isInFace(point)) return std::nullopt;
  // The outside is on the left: a tangent line runs along the covector turned to the right, and the
  // cross product with that covector tells how far.
  const auto along = [](const FacePoint& plane, const FacePoint& way) {
    return cross(way, plane) / std::hypot(plane[0], plane[1]);
  };
  if (along(from.plane, step(from.at, point)) < kMargin ||
      along(to.plane, step(point, to.at)) < kMargin) {
    return std::nullopt;
  }
  return point;
}

bool joinsInside(uniform::CornerMask mask, int face, const std::array<FaceCrossing, 4>& crossings,
                 double leastCosine, bool otherwise) {
  const bool apartMeet = arcsIntersect(arcsOf(mask, face, false), crossings, leastCosine);
  const bool joinedMeet = arcsIntersect(arcsOf(mask, face, true), crossings, leastCosine);
  return apartMeet == joinedMeet ? otherwise : apartMeet;
}

}  // namespace tufa::extraction
