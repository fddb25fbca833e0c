#include "base/triangulate.h"

#include <algorithm>
#include <cstddef>

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

std::vector<Triangle> base::triangulate(const Mesh& mesh, Job& job) {
  const std::size_t first = mesh.triangles.size();
  std::vector<Triangle> triangles;
  base::resizeLarge(triangles, mesh.triangleCount(), job);
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles.begin());
  job.forRanges(mesh.quads.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& v = mesh.quads[i].vertices;
      triangles[first + 2 * i] = {v[0], v[1], v[2]};
      triangles[first + 2 * i + 1] = {v[0], v[2], v[3]};
    }
  });
  return triangles;
}

}  // namespace tufa
