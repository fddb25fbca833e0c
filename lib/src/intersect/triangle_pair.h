#pragma once

#include <tufa/mesh.h>
#include <span>

namespace tufa::intersect {

/// Whether two triangles meet elsewhere than in the vertices or the edge whose indices they share,
/// decided exactly. Triangles over one edge do if one is folded flat onto the other, triangles at
/// one vertex if the far edge of one meets the other, any others if they touch at all. Triangles
/// whose corners lie on a line meet nothing. The same definition as that of check().
[[nodiscard]] bool intersectElsewhere(std::span<const Position> positions, const Triangle& a,
                                      const Triangle& b);

/// A quick test in floating point: whether a plane surely parts the points `a` from the points `b`;
/// if `common`, one through the point `at`, with none of them on it. No answer is no proof. `at` is
/// near the points, so that differences to it lose nothing.
[[nodiscard]] bool arePartedAt(const Position& at, std::span<const Position> a,
                               std::span<const Position> b, bool common);

/// The same of a plane through the line from one point to another, with none of `a` and `b` on it:
/// what is spanned by these and by the two points meets on that line alone.
[[nodiscard]] bool arePartedAlong(const Position& from, const Position& to,
                                  std::span<const Position> a, std::span<const Position> b);

/// Whether the corners of a triangle lie on a line.
[[nodiscard]] bool isFlat(std::span<const Position> positions, const Triangle& triangle);

}  // namespace tufa::intersect
