#include "intersect/triangle_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/vec3.h"
#include "intersect/exact.h"

namespace tufa::intersect {
namespace {

using TrianglePlaces = std::array<Position, 3>;

// Above the rounding of a scalar product of differences, at most 4 half ulps or 4.5e-16, relative
// to its terms.
constexpr double kRounding = 1e-15;
// Sine of an angle far above all rounding.
constexpr double kClearly = 1e-6;
// What is taken off for what moves, as a factor of its square: more than any of its terms of higher
// order.
constexpr double kSpare = 2;

Vec3 between(const Position& from, const Position& to) {
  return {to.x - from.x, to.y - from.y, to.z - from.z};
}

// Moves the common vertices of two triangles to their fronts, in the same order; returns how many.
int alignShared(std::array<VertexIndex, 3>& a, std::array<VertexIndex, 3>& b) {
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    const auto found = std::find(b.begin() + shared, b.end(), a[i]);
    if (found == b.end()) continue;
    std::iter_swap(b.begin() + shared, found);
    std::swap(a[shared], a[i]);
    ++shared;
  }
  return shared;
}

// A quick answer for triangles at a common edge: certainly not folded over, as the third corners
// lie on opposite sides of the edge.
bool isUnfolded(const TrianglePlaces& a, const TrianglePlaces& b) {
  const Vec3 edge = between(a[0], a[1]), own = between(a[0], a[2]), other = between(a[0], b[2]);
  const Vec3 across = own * edge.squaredLength() - edge * own.dot(edge);
  if (across.length() < kClearly * edge.squaredLength() * own.length()) return false;
  return across.dot(other) < -kClearly * across.length() * other.length();
}

// An axis along which the triangle is seen with an area; -1 if its corners lie on a line. Exact.
int facingAxis(const TrianglePlaces& t) {
  for (int axis = 0; axis < 3; ++axis) {
    if (orientationAcross(axis, t[0], t[1], t[2]) != 0) return axis;
  }
  return -1;
}

// A segment and a triangle in one plane. Two convex figures are disjoint exactly if a line along an
// edge of one separates them, so the edges of the triangle and the segment itself are tried.
bool intersectsInPlane(const Position& p, const Position& q, const TrianglePlaces& t) {
  const int axis = facingAxis(t);
  if (axis < 0) return false;
  const int turn = orientationAcross(axis, t[0], t[1], t[2]);
  for (int i = 0; i < 3; ++i) {
    const Position& from = t[i];
    const Position& to = t[(i + 1) % 3];
    if (orientationAcross(axis, from, to, p) == -turn &&
        orientationAcross(axis, from, to, q) == -turn) {
      return false;
    }
  }
  const int first = orientationAcross(axis, p, q, t[0]);
  return first == 0 || first != orientationAcross(axis, p, q, t[1]) ||
         first != orientationAcross(axis, p, q, t[2]);
}

// Whether a segment touches a triangle. If its ends are not on the same side of the plane, the line
// through them crosses the plane in one point of the segment. That point is in the triangle unless
// the line has one edge of it on its left and another on its right. An end in the plane and a line
// through an edge or a vertex give zeros, which count as touching.
bool segmentIntersects(const Position& p, const Position& q, const TrianglePlaces& t) {
  const int sideP = orientation(t[0], t[1], t[2], p), sideQ = orientation(t[0], t[1], t[2], q);
  if (sideP == sideQ) return sideP == 0 && intersectsInPlane(p, q, t);
  bool left = false, right = false;
  for (int i = 0; i < 3; ++i) {
    const int side = orientation(p, q, t[i], t[(i + 1) % 3]);
    left |= side > 0;
    right |= side < 0;
  }
  return !(left && right);
}

// Whether all corners of b but the first `skip` are strictly on one side of the plane of a: then
// they have at most those `skip` corners in common.
bool isBeside(const TrianglePlaces& a, const TrianglePlaces& b, int skip) {
  const int side = orientation(a[0], a[1], a[2], b[skip]);
  if (side == 0) return false;
  for (int i = skip + 1; i < 3; ++i) {
    if (orientation(a[0], a[1], a[2], b[i]) != side) return false;
  }
  return true;
}

// Two triangles intersect exactly if an edge of one touches the other. Both plane tests come first:
// they settle most pairs with three determinants each.
bool intersectAnywhere(const TrianglePlaces& a, const TrianglePlaces& b) {
  if (isBeside(a, b, 0) || isBeside(b, a, 0)) return false;
  for (int i = 0; i < 3; ++i) {
    if (segmentIntersects(a[i], a[(i + 1) % 3], b) || segmentIntersects(b[i], b[(i + 1) % 3], a))
      return true;
  }
  return false;
}

// Triangles at a common vertex: where they intersect beyond it, the intersection ends at the far
// edge of one of them.
bool intersectBeyondVertex(const TrianglePlaces& a, const TrianglePlaces& b) {
  if (isBeside(a, b, 1) || isBeside(b, a, 1)) return false;
  return segmentIntersects(b[1], b[2], a) || segmentIntersects(a[1], a[2], b);
}

// Triangles at a common edge intersect beyond it only in one plane and on the same side of the
// edge.
bool isFoldedOver(const TrianglePlaces& a, const TrianglePlaces& b) {
  if (isUnfolded(a, b)) return false;
  if (orientation(a[0], a[1], a[2], b[2]) != 0) return false;
  const int axis = facingAxis(a);
  return axis >= 0 &&
         orientationAcross(axis, a[0], a[1], a[2]) == orientationAcross(axis, a[0], a[1], b[2]);
}

}  // namespace

// Points that move, and a plane that moves with `at`, come nearer to each other by `margin` at
// most.
bool areSeparatedAt(const Position& at, std::span<const Position> a, std::span<const Position> b,
                    bool common, double margin) {
  Vec3 toA(0), toB(0);
  for (const Position& p : a) toA += between(at, p);
  for (const Position& p : b) toB += between(at, p);
  const double weightA = common ? toA.length() : static_cast<double>(a.size());
  const double weightB = common ? toB.length() : static_cast<double>(b.size());
  if (!(weightA > 0 && weightB > 0)) return false;
  const Vec3 way = toA / weightA - toB / weightB;
  double leastA = std::numeric_limits<double>::infinity(), mostB = -leastA, terms = 0;
  const auto along = [&](const Position& p) {
    const Vec3 offset = between(at, p);
    terms = std::max(terms, std::abs(way[0] * offset[0]) + std::abs(way[1] * offset[1]) +
                                std::abs(way[2] * offset[2]));
    return way.dot(offset);
  };
  for (const Position& p : a) leastA = std::min(leastA, along(p));
  for (const Position& p : b) mostB = std::max(mostB, along(p));
  // Off the plane; and half the distance of the two sets.
  double least = kRounding * terms;
  if (margin > 0) least += (common ? 1.0 : 0.5) * margin * way.length();
  return common ? leastA > least && mostB < -least : leastA - mostB > 2 * least;
}

// The plane through the line moves by half of `margin` at `from` and turns by no more than `margin`
// over the length of the edge: with the point's own half that is margin * (1 + distance / length).
// The square of the sum is at most twice the sum of the squares.
bool areSeparatedAlong(const Position& from, const Position& to, std::span<const Position> a,
                       std::span<const Position> b, double margin) {
  const Vec3 edge = between(from, to);
  const double length = edge.squaredLength();
  if (!(length > 0)) return false;
  const auto directionAcross = [&](std::span<const Position> points) {
    Vec3 sum(0);
    for (const Position& p : points) sum += between(from, p);
    sum -= edge * (sum.dot(edge) / length);
    return sum / sum.length();  // not a number if they lie on the line
  };
  const Vec3 way = directionAcross(a) - directionAcross(b);
  // Rounding keeps `way` from being exactly perpendicular to the edge. If it tilts by less than
  // kClearly / 2, the plane that does contain the edge has the same points on each side, as each
  // point is off this one by an angle of kClearly.
  const double way2 = way.squaredLength(), squared = kClearly * kClearly * way2;
  const double along = way.dot(edge);
  if (!(4 * along * along < squared * length)) return false;
  const auto isBeyond = [&](const Position& p, double side) {
    const Vec3 offset = between(from, p);
    const double height = side * way.dot(offset), distance2 = offset.squaredLength();
    const double turned2 = 2 * margin * margin * (1 + distance2 / length);
    return height > 0 && height * height > squared * distance2 + kSpare * way2 * turned2;
  };
  return std::all_of(a.begin(), a.end(), [&](const Position& p) { return isBeyond(p, 1); }) &&
         std::all_of(b.begin(), b.end(), [&](const Position& p) { return isBeyond(p, -1); });
}

bool intersectElsewhere(std::span<const Position> positions, const Triangle& a, const Triangle& b) {
  auto va = a.vertices;
  auto vb = b.vertices;
  const int shared = alignShared(va, vb);
  const TrianglePlaces pa{positions[va[0]], positions[va[1]], positions[va[2]]};
  const TrianglePlaces pb{positions[vb[0]], positions[vb[1]], positions[vb[2]]};
  const std::size_t skip = shared == 1 ? 1 : 0;
  if (shared <= 1 && areSeparatedAt(pa[0], std::span(pa).subspan(skip), std::span(pb).subspan(skip),
                                    shared == 1)) {
    return false;
  }
  const bool meet = shared == 0   ? intersectAnywhere(pa, pb)
                    : shared == 1 ? intersectBeyondVertex(pa, pb)
                    : shared == 2 ? isFoldedOver(pa, pb)
                                  : true;
  return meet && facingAxis(pa) >= 0 && facingAxis(pb) >= 0;
}

bool isFlat(std::span<const Position> positions, const Triangle& triangle) {
  const auto& v = triangle.vertices;
  return facingAxis({positions[v[0]], positions[v[1]], positions[v[2]]}) < 0;
}

}  // namespace tufa::intersect
