#pragma once

#include <tufa/mesh.h>

#include <vector>

namespace tufa::extraction {

/// Triangles that one block adds to a mesh, and the vertices it adds with them, which count on from
/// those that the mesh had before any block was added.
struct BlockTriangles {
  std::vector<Triangle> triangles;
  std::vector<Position> positions;
  std::vector<Normal> normals;
};

/// Adds the triangles and vertices of all blocks, in their order, to a mesh with normals. `before`
/// is the number from which the blocks count their own vertices; the mesh may have more by now.
void appendBlocks(const std::vector<BlockTriangles>& blocks, std::size_t before, Mesh& mesh);

}  // namespace tufa::extraction
