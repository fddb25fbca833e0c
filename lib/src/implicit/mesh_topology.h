#pragma once

#include <tufa/mesh.h>

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec3.h"

namespace tufa::implicit {

/// The triangles of a mesh that have three different corners; equal positions are one vertex where
/// that closes edges which are open else.
struct TriangleSet {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Throws Error(InvalidArgument) for meshes without faces or with vertices that are no numbers.
[[nodiscard]] TriangleSet trianglesOf(const Mesh& mesh);

/// The triangle beyond each edge, of all triangles: edge k runs from corner k to the next. Throws
/// Error(InvalidArgument) unless each edge has two faces that turn the same way, and for meshes
/// that face inward.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> neighboursIn(TriangleSet& set);

}  // namespace tufa::implicit
