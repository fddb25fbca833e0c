#pragma once

#include <tufa/mesh.h>
#include <span>

namespace tufa::intersect {

/// Whether two triangles intersect elsewhere than in the vertices or the edge whose indices they
/// share, decided exactly. Triangles at a common edge do if one is folded flat onto the other,
/// triangles at a common vertex if the far edge of one touches the other, any others if they touch
/// at all. Triangles whose corners lie on a line intersect nothing. check() uses the same
/// definition.
[[nodiscard]] bool intersectElsewhere(std::span<const Position> positions, const Triangle& a,
                                      const Triangle& b);

/// A quick test in floating point: whether a plane certainly separates the points `a` from the
/// points `b`; if `common`, a plane through the point `at`, with none of them on it. True is a
/// proof, even if each point moves by half of `margin`; false means nothing. `at` must be near the
/// points, so that differences to it lose little.
[[nodiscard]] bool areSeparatedAt(const Position& at, std::span<const Position> a,
                                  std::span<const Position> b, bool common, double margin = 0);

/// The same for a plane through the line from one point to another, with none of `a` and `b` on it:
/// the hulls of these and the two points have that line alone in common.
[[nodiscard]] bool areSeparatedAlong(const Position& from, const Position& to,
                                     std::span<const Position> a, std::span<const Position> b,
                                     double margin = 0);

/// Whether the corners of a triangle lie on a line.
[[nodiscard]] bool isFlat(std::span<const Position> positions, const Triangle& triangle);

}  // namespace tufa::intersect
