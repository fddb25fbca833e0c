#pragma once

#include <tufa/mesh.h>
#include <vector>

namespace tufa::checks {

/// Exact predicates by CGAL's filtered kernel: correct for any finite coordinates. Indices must be
/// in range. Thread-safe.

/// True if the three vertices lie on one line.
[[nodiscard]] bool areCollinear(const std::vector<Position>& positions, const Triangle& triangle);

/// True if two triangles intersect elsewhere than in the vertices or the edge whose indices they
/// share. Neither may be collinear.
[[nodiscard]] bool intersectElsewhere(const std::vector<Position>& positions, const Triangle& a,
                                      const Triangle& b);

/// True if the point lies on the triangle, which must not be collinear.
[[nodiscard]] bool liesOn(const std::vector<Position>& positions, const Triangle& triangle,
                          const Position& point);

/// True if the vertical ray that starts at `from` and goes up passes through the triangle.
///
/// The ray is moved aside by an infinitesimal (simulation of simplicity, Edelsbrunner and Mücke
/// 1990), so a ray through an edge or a vertex passes through one of the triangles around it, or
/// through as many from below as from above.
[[nodiscard]] bool liesAbove(const std::vector<Position>& positions, const Triangle& triangle,
                             const Position& from);

}  // namespace tufa::checks
