#include <tufa/float_mesh.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "base/known_enum.h"
#include "base/require_at_most.h"
#include "base/require_mesh.h"
#include "io/mesh/float_precision.h"
#include "io/mesh/mesh_format.h"

namespace tufa {
namespace {

/// The middle of the mesh where its positions need more than single precision.
Position originOf(const Mesh& mesh) {
  if (!io::needsDoublePrecision(mesh)) return {0, 0, 0};
  const io::Bounds bounds = io::boundsOf(mesh);
  return {0.5 * (bounds.least.x + bounds.greatest.x), 0.5 * (bounds.least.y + bounds.greatest.y),
          0.5 * (bounds.least.z + bounds.greatest.z)};
}

template <class Face>
void addFace(const Face& face, Winding winding, FloatMesh& out) {
  out.faceCounts.push_back(static_cast<int>(face.vertices.size()));
  const auto begin = out.faceIndices.end() - out.faceIndices.begin();
  for (const VertexIndex vertex : face.vertices) {
    out.faceIndices.push_back(static_cast<int>(vertex));
  }
  // The first corner stays the first: quads are split from there.
  if (winding == Winding::Clockwise) {
    std::reverse(out.faceIndices.begin() + begin + 1, out.faceIndices.end());
  }
}

}  // namespace

FloatMesh toFloat(const Mesh& mesh, const FloatMeshOptions& options) {
  base::requireKnown(options.winding, Winding::Clockwise, "the winding");
  base::requireFaces(mesh);
  base::requireFinite(mesh);
  io::requireFloatRange(mesh);
  base::requireNormals(mesh);
  constexpr std::uint64_t kMost = std::numeric_limits<int>::max();
  const std::uint64_t corners =
      4 * std::uint64_t{mesh.quads.size()} + 3 * std::uint64_t{mesh.triangles.size()};
  base::requireAtMost(kMost, mesh.positions.size(), "positions", "an int");
  base::requireAtMost(kMost, corners, "corners", "an int");
  FloatMesh out;
  if (options.relative) out.origin = originOf(mesh);
  out.positions.reserve(mesh.positions.size());
  for (const Position& p : mesh.positions) {
    out.positions.push_back({static_cast<float>(p.x - out.origin.x),
                             static_cast<float>(p.y - out.origin.y),
                             static_cast<float>(p.z - out.origin.z)});
  }
  out.normals.reserve(mesh.normals.size());
  for (const Normal& n : mesh.normals) out.normals.push_back({n.x, n.y, n.z});
  out.faceCounts.reserve(mesh.quads.size() + mesh.triangles.size());
  out.faceIndices.reserve(corners);
  for (const Quad& quad : mesh.quads) addFace(quad, options.winding, out);
  for (const Triangle& triangle : mesh.triangles) addFace(triangle, options.winding, out);
  return out;
}

}  // namespace tufa
