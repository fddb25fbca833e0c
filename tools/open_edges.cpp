#include "open_edges.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

#include "console.h"

namespace tufa::tools {
namespace {

/// For each vertex the first one at its place.
std::vector<VertexIndex> namesByPlace(const Mesh& mesh) {
  std::vector<VertexIndex> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), VertexIndex{0});
  const auto placeOf = [&](VertexIndex v) {
    const Position& p = mesh.positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](VertexIndex a, VertexIndex b) {
    return placeOf(a) != placeOf(b) ? placeOf(a) < placeOf(b) : a < b;
  });
  std::vector<VertexIndex> names(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool isSame = i > 0 && placeOf(order[i]) == placeOf(order[i - 1]);
    names[order[i]] = isSame ? names[order[i - 1]] : order[i];
  }
  return names;
}

}  // namespace

std::size_t countOpenEdges(const Mesh& mesh) {
  const std::vector<VertexIndex> names = namesByPlace(mesh);
  std::vector<std::uint64_t> edges;
  edges.reserve(4 * mesh.quads.size() + 3 * mesh.triangles.size());
  const auto addFace = [&](const auto& vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::uint64_t a = names[vertices[i]], b = names[vertices[(i + 1) % vertices.size()]];
      if (a != b) edges.push_back(std::min(a, b) << 32 | std::max(a, b));
    }
  };
  for (const Quad& quad : mesh.quads) addFace(quad.vertices);
  for (const Triangle& triangle : mesh.triangles) addFace(triangle.vertices);
  std::sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const bool isAlone =
        (i == 0 || edges[i - 1] != edges[i]) && (i + 1 == edges.size() || edges[i + 1] != edges[i]);
    open += isAlone ? 1 : 0;
  }
  return open;
}

void noteOpenMesh(const Mesh& mesh, const std::string& what) {
  const std::size_t open = countOpenEdges(mesh);
  if (open == 0) return;
  printNote("note: the mesh is open, with " + formatCount(open) + (open == 1 ? " edge" : " edges") +
            " of one face: " + what + " is uncertain there; tufa repair closes holes");
}

}  // namespace tufa::tools
