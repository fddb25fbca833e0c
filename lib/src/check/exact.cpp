#include "check/exact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tufa::checks {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

Point toPoint(const Position& p) { return {p.x, p.y, p.z}; }

/// Moves the common vertices of two triangles to their fronts, in the same order; returns their
/// number.
int alignShared(std::array<VertexIndex, 3>& a, std::array<VertexIndex, 3>& b) {
  int shared = 0;
  for (int i = shared; i < 3; ++i) {
    const auto found = std::find(b.begin() + shared, b.end(), a[i]);
    if (found == b.end()) continue;
    std::iter_swap(b.begin() + shared, found);
    std::swap(a[shared], a[i]);
    ++shared;
  }
  return shared;
}

/// Triangles at a common edge intersect elsewhere only if one is folded onto the other.
bool foldedOver(const std::array<Point, 3>& a, const Point& opposite) {
  return CGAL::orientation(a[0], a[1], a[2], opposite) == CGAL::COPLANAR &&
         CGAL::coplanar_orientation(a[0], a[1], a[2], opposite) == CGAL::POSITIVE;
}

/// Triangles at a common vertex intersect elsewhere only if the far edge of one touches the other.
bool intersectBeyondVertex(const std::array<Point, 3>& a, const std::array<Point, 3>& b) {
  // Most pairs end here: if the far edge of b is on one side of a's plane, b touches that plane in
  // the shared vertex alone.
  const auto first = CGAL::orientation(a[0], a[1], a[2], b[1]);
  if (first != CGAL::COPLANAR && first == CGAL::orientation(a[0], a[1], a[2], b[2])) return false;
  return CGAL::do_intersect(Kernel::Triangle_3(a[0], a[1], a[2]), Kernel::Segment_3(b[1], b[2])) ||
         CGAL::do_intersect(Kernel::Triangle_3(b[0], b[1], b[2]), Kernel::Segment_3(a[1], a[2]));
}

/// On which side of the line from a to b the point lies, all seen from above: 1 left, -1 right.
/// The point is moved by (e, e*e) for an infinitesimal e, so 0 means that a is above b.
int sideSeenFromAbove(const Position& a, const Position& b, const Position& point) {
  const auto side = CGAL::orientation(Kernel::Point_2(a.x, a.y), Kernel::Point_2(b.x, b.y),
                                      Kernel::Point_2(point.x, point.y));
  if (side != CGAL::COLLINEAR) return side;
  if (a.y != b.y) return a.y > b.y ? 1 : -1;
  if (a.x != b.x) return b.x > a.x ? 1 : -1;
  return 0;
}

}  // namespace

bool areCollinear(const std::vector<Position>& positions, const Triangle& triangle) {
  const auto& v = triangle.vertices;
  return CGAL::collinear(toPoint(positions[v[0]]), toPoint(positions[v[1]]),
                         toPoint(positions[v[2]]));
}

bool intersectElsewhere(const std::vector<Position>& positions, const Triangle& a,
                        const Triangle& b) {
  auto va = a.vertices;
  auto vb = b.vertices;
  const int shared = alignShared(va, vb);
  if (shared == 3) return true;
  const std::array<Point, 3> pa{toPoint(positions[va[0]]), toPoint(positions[va[1]]),
                                toPoint(positions[va[2]])};
  const std::array<Point, 3> pb{toPoint(positions[vb[0]]), toPoint(positions[vb[1]]),
                                toPoint(positions[vb[2]])};
  if (shared == 2) return foldedOver(pa, pb[2]);
  if (shared == 1) return intersectBeyondVertex(pa, pb);
  return CGAL::do_intersect(Kernel::Triangle_3(pa[0], pa[1], pa[2]),
                            Kernel::Triangle_3(pb[0], pb[1], pb[2]));
}

bool liesOn(const std::vector<Position>& positions, const Triangle& triangle,
            const Position& point) {
  const auto& v = triangle.vertices;
  return Kernel::Triangle_3(toPoint(positions[v[0]]), toPoint(positions[v[1]]),
                            toPoint(positions[v[2]]))
      .has_on(toPoint(point));
}

bool liesAbove(const std::vector<Position>& positions, const Triangle& triangle,
               const Position& from) {
  const Position& a = positions[triangle.vertices[0]];
  const Position& b = positions[triangle.vertices[1]];
  const Position& c = positions[triangle.vertices[2]];
  const int side = sideSeenFromAbove(a, b, from);
  if (side == 0 || side != sideSeenFromAbove(b, c, from) || side != sideSeenFromAbove(c, a, from)) {
    return false;
  }
  return side * CGAL::orientation(toPoint(a), toPoint(b), toPoint(c), toPoint(from)) < 0;
}

}  // namespace tufa::checks
