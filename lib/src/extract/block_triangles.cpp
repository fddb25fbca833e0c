#include "extract/block_triangles.h"

#include "uniform/uniform_surface.h"

namespace tufa::extraction {

void appendBlocks(const std::vector<BlockTriangles>& blocks, std::size_t before, Mesh& mesh) {
  std::size_t triangles = mesh.triangles.size(), vertices = mesh.positions.size();
  for (const BlockTriangles& block : blocks) {
    triangles += block.triangles.size();
    vertices += block.positions.size();
  }
  uniform::requireIndexable(vertices);
  mesh.triangles.reserve(triangles);
  mesh.positions.reserve(vertices);
  mesh.normals.reserve(vertices);
  for (const BlockTriangles& block : blocks) {
    const auto moved = static_cast<VertexIndex>(mesh.positions.size() - before);
    for (Triangle triangle : block.triangles) {
      for (VertexIndex& vertex : triangle.vertices) vertex += vertex >= before ? moved : 0;
      mesh.triangles.push_back(triangle);
    }
    mesh.positions.insert(mesh.positions.end(), block.positions.begin(), block.positions.end());
    mesh.normals.insert(mesh.normals.end(), block.normals.begin(), block.normals.end());
  }
}

}  // namespace tufa::extraction
