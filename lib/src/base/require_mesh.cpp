#include "base/require_mesh.h"

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace tufa::base {

void requireFaces(const Mesh& mesh) {
  const auto requireInside = [&](const auto& face) {
    for (const VertexIndex vertex : face.vertices) {
      if (vertex < mesh.positions.size()) continue;
      throw Error(ErrorCode::InvalidArgument, "a face names vertex " + std::to_string(vertex) +
                                                  " of " + std::to_string(mesh.positions.size()));
    }
  };
  std::for_each(mesh.triangles.begin(), mesh.triangles.end(), requireInside);
  std::for_each(mesh.quads.begin(), mesh.quads.end(), requireInside);
}

void requireNormals(const Mesh& mesh) {
  if (mesh.normals.empty() || mesh.normals.size() == mesh.positions.size()) return;
  throw Error(ErrorCode::InvalidArgument, "the mesh has " + std::to_string(mesh.normals.size()) +
                                              " normals for " +
                                              std::to_string(mesh.positions.size()) + " positions");
}

void requireFinite(const Mesh& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Position& p = mesh.positions[v];
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
    throw Error(ErrorCode::InvalidArgument,
                "vertex " + std::to_string(v) + " of the mesh is not finite");
  }
}

}  // namespace tufa::base
