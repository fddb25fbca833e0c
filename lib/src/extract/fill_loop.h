#pragma once

#include <tufa/mesh.h>

#include <cstdint>
#include <vector>

#include "extract/block_triangles.h"

namespace tufa::extraction {

/// A corner of a loop on the faces of a cube.
struct LoopCorner {
  VertexIndex vertex = 0;
  std::uint8_t faces = 0;  ///< a bit for each face of the cube that it lies on
};

/// Fills a loop of three corners or more by triangles that run around as it does: by the chords
/// with the least sum of squared lengths, none of which lies in a face of the cube; or where there
/// are none, or more than a few corners, by a fan around the mean of the corners. `mesh` holds
/// the corners; a vertex that is added gets the number of its vertices plus its place in `to`.
void fillLoop(const std::vector<LoopCorner>& loop, const Mesh& mesh, BlockTriangles& to);

}  // namespace tufa::extraction
