#pragma once

#include <tufa/mesh.h>
#include <span>

namespace tufa::mend {

/// Whether two triangles meet elsewhere than in the vertices or the edge whose indices they share,
/// decided exactly. Triangles over one edge do if one is folded flat onto the other, triangles at
/// one vertex if the far edge of one meets the other, any others if they touch at all. Triangles
/// whose corners lie on a line meet nothing. The same definition as that of check().
[[nodiscard]] bool meetElsewhere(std::span<const Position> positions, const Triangle& a,
                                 const Triangle& b);

/// Whether the corners of a triangle lie on a line.
[[nodiscard]] bool isFlat(std::span<const Position> positions, const Triangle& triangle);

}  // namespace tufa::mend
