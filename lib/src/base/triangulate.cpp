#include <tufa/mesh.h>

#include "base/huge_pages.h"

namespace tufa {

std::vector<Triangle> triangulate(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  base::reserveLarge(triangles, mesh.triangleCount());
  triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  for (const Quad& quad : mesh.quads) {
    const auto& v = quad.vertices;
    triangles.emplace_back(v[0], v[1], v[2]);
    triangles.emplace_back(v[0], v[2], v[3]);
  }
  return triangles;
}

}  // namespace tufa
