#include "polygons/diagonal.h"

#include <algorithm>
#include <cmath>

namespace tufa::polygons {
namespace {

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Distances along the lattice edge that differ by less than this, in voxels, count as equal.
constexpr double kSameDistance = 0.02;

// One way to split: what the two triangles look like from the lattice edge.
struct Split {
  bool folded = false;   // a triangle faces inward along the edge
  double distance = 0;   // from the crossing to the triangles, along the edge, in voxels
  double shape = 0;      // grows with the smallest angle
};

// Squared sine of the smallest angle, near enough: twice the area against the longest side, squared.
double shapeOf(const Point& a, const Point& b, const Point& c, const Point& normal) {
  const Point ab = minus(b, a), bc = minus(c, b), ca = minus(a, c);
  const std::array<double, 3> sides = {dot(ab, ab), dot(bc, bc), dot(ca, ca)};
  const double longest = *std::max_element(sides.begin(), sides.end());
  return longest > 0 ? dot(normal, normal) / (longest * longest) : 0;
}

Split splitFrom(const std::array<Point, 4>& p, int first, const Point& crossing,
                const Point& direction) {
  const Point& a = p[first];
  const Point& b = p[first + 1];
  const Point& c = p[first + 2];
  const Point& d = p[(first + 3) % 4];
  const Point diagonal = minus(c, a);
  const Point toCrossing = minus(crossing, a);
  const Point normals[2] = {cross(minus(b, a), diagonal), cross(diagonal, minus(d, a))};
  const double facing[2] = {dot(normals[0], direction), dot(normals[1], direction)};
  // Seen along the edge, the crossing lies right of the diagonal in the first triangle, else left.
  const int under = dot(cross(diagonal, toCrossing), direction) < 0 ? 0 : 1;
  Split split;
  split.folded = facing[0] <= 0 || facing[1] <= 0;
  split.distance = facing[under] != 0 ? std::abs(dot(normals[under], toCrossing) / facing[under])
                                      : 1;
  split.shape = std::min(shapeOf(a, b, c, normals[0]), shapeOf(a, c, d, normals[1]));
  return split;
}

}  // namespace

bool secondDiagonalIsBetter(const std::array<Point, 4>& corners, const Point& crossing,
                            const Point& direction) {
  const Split even = splitFrom(corners, 0, crossing, direction);
  const Split odd = splitFrom(corners, 1, crossing, direction);
  if (even.folded != odd.folded) return even.folded;
  if (std::abs(even.distance - odd.distance) > kSameDistance) return odd.distance < even.distance;
  return odd.shape > even.shape;
}

}  // namespace tufa::polygons
