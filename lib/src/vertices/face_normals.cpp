#include <algorithm>
#include <cmath>

#include "vertices/place_vertices.h"

namespace tufa::vertices {
namespace {

openvdb::Vec3d at(const Mesh& mesh, VertexIndex vertex) {
  const Position& p = mesh.positions[vertex];
  return {p.x, p.y, p.z};
}

}  // namespace

void setFaceNormals(Mesh& mesh, base::Job& job) {
  // Serial sums, so that their order does not depend on the number of threads.
  std::vector<openvdb::Vec3d> sums(mesh.positions.size(), openvdb::Vec3d(0));
  for (const Triangle& triangle : triangulate(mesh)) {
    const auto& v = triangle.vertices;
    const openvdb::Vec3d p[3] = {at(mesh, v[0]), at(mesh, v[1]), at(mesh, v[2])};
    openvdb::Vec3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (!normal.normalize()) continue;
    for (int i = 0; i < 3; ++i) {
      openvdb::Vec3d a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
      if (!a.normalize() || !b.normalize()) continue;
      sums[v[i]] += normal * std::acos(std::clamp(a.dot(b), -1.0, 1.0));
    }
  }
  mesh.normals.resize(mesh.positions.size());
  job.forRanges(sums.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      openvdb::Vec3d n = sums[i];
      if (!n.normalize()) n = openvdb::Vec3d(0);
      mesh.normals[i] = {static_cast<float>(n[0]), static_cast<float>(n[1]),
                         static_cast<float>(n[2])};
    }
  });
}

}  // namespace tufa::vertices
