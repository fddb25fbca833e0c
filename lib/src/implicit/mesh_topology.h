#pragma once

#include <tufa/mesh.h>

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec3.h"

namespace tufa::implicit {

/// The triangles of a mesh that have three different corners.
struct TriangleSet {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  [[nodiscard]] std::array<Vec3, 3> cornersOf(const std::array<std::uint32_t, 3>& t) const {
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
};

/// Throws Error(InvalidArgument) for meshes without faces or with vertices that are no numbers.
[[nodiscard]] TriangleSet trianglesOf(const Mesh& mesh);

/// The triangle beyond each edge, of all triangles: edge k runs from corner k to the next. Equal
/// positions become one vertex where edges are open else, or of no length. Other triangles without
/// area are given a part of a neighbour's, so that all have a normal. Throws Error(InvalidArgument)
/// unless each edge has two faces that turn the same way, for meshes that face inward, and for
/// those with parts that have no area.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> neighboursIn(TriangleSet& set);

}  // namespace tufa::implicit
