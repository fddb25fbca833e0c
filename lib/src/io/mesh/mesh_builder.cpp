#include "io/mesh/mesh_builder.h"

#include <limits>

namespace tufa::io {

void MeshBuilder::addFace(std::span<const std::uint64_t> corners, std::uint64_t positionCount,
                          const Fail& fail) {
  constexpr std::uint64_t kMost = std::numeric_limits<VertexIndex>::max();
  if (positionCount > kMost) {
    fail("there are " + std::to_string(positionCount) +
         " vertices, more than a mesh can have: " + std::to_string(kMost));
  }
  for (const std::uint64_t corner : corners) {
    if (corner >= positionCount) {
      fail("a face names vertex " + std::to_string(corner) + " of " +
           std::to_string(positionCount));
    }
  }
  const auto at = [&](std::size_t n) { return static_cast<VertexIndex>(corners[n]); };
  if (corners.size() == 4) {
    mesh_.quads.emplace_back(at(0), at(1), at(2), at(3));
    return;
  }
  for (std::size_t n = 2; n < corners.size(); ++n) {
    mesh_.triangles.emplace_back(at(0), at(n - 1), at(n));
  }
}

}  // namespace tufa::io
