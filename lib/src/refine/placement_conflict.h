#pragma once

#include <tufa/mesh.h>
#include <algorithm>
#include <array>
#include <cstdint>

namespace tufa::refine {

/// A fold, an intersecting pair, or two vertices at one point. No larger than it must be: a surface
/// that touches itself everywhere has thirty for each voxel.
struct Conflict {
  enum class Kind : std::uint8_t { SamePoint, Fold, Pair };
  Kind kind = Kind::SamePoint;
  /// The faces of a fold; the quads of a pair; twice the quad of two vertices at one point.
  std::array<std::uint32_t, 2> parts{};
  std::array<VertexIndex, 2> edge{};  ///< of a fold; or the two vertices at one point
};

/// A vertex that is taken to be somewhere else; none by default.
struct Trial {
  VertexIndex vertex = ~VertexIndex{0};
  Position to{0, 0, 0};
};

/// The vertices that a conflict is between.
struct Involved {
  std::array<VertexIndex, 8> vertices;
  int count = 0;
  void add(VertexIndex vertex) {
    const auto* end = vertices.begin() + count;
    if (std::find(vertices.begin(), vertices.begin() + count, vertex) == end)
      vertices[count++] = vertex;
  }
};

}  // namespace tufa::refine
