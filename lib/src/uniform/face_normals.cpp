#include <algorithm>
#include <cmath>

#include "base/huge_pages.h"
#include "uniform/place_vertices.h"

namespace tufa::uniform {
namespace {

Vec3 at(const Mesh& mesh, VertexIndex vertex) {
  const Position& p = mesh.positions[vertex];
  return {p.x, p.y, p.z};
}

}  // namespace

void setFaceNormals(Mesh& mesh, base::Job& job) {
  // Serial sums, so that their order does not depend on the number of threads.
  std::vector<Vec3> sums;
  base::resizeLarge(sums, mesh.positions.size(), job, Vec3(0));
  for (const Triangle& triangle : triangulate(mesh)) {
    const auto& v = triangle.vertices;
    const Vec3 p[3] = {at(mesh, v[0]), at(mesh, v[1]), at(mesh, v[2])};
    Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (!normal.normalize()) continue;
    for (int i = 0; i < 3; ++i) {
      Vec3 a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
      if (!a.normalize() || !b.normalize()) continue;
      sums[v[i]] += normal * std::acos(std::clamp(a.dot(b), -1.0, 1.0));
    }
  }
  base::resizeLarge(mesh.normals, mesh.positions.size(), job);
  job.forRanges(sums.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 n = sums[i];
      if (!n.normalize()) n = Vec3(0);
      mesh.normals[i] = {static_cast<float>(n[0]), static_cast<float>(n[1]),
                         static_cast<float>(n[2])};
    }
  });
}

}  // namespace tufa::uniform
