#include "open_edges.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

#include "base/bits.h"
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

/// Calls visit(a, b) for the edges of all faces.
template <class Visit>
void forEdges(const Mesh& mesh, const Visit& visit) {
  const auto visitFace = [&](const auto& v) {
    for (std::size_t i = 0; i < v.size(); ++i) visit(v[i], v[(i + 1) % v.size()]);
  };
  for (const Quad& quad : mesh.quads) visitFace(quad.vertices);
  for (const Triangle& triangle : mesh.triangles) visitFace(triangle.vertices);
}

std::uint64_t keyOf(std::uint64_t a, std::uint64_t b) {
  return std::min(a, b) << 32 | std::max(a, b);
}

/// Whether every edge has an even number of faces, without a look at places: by the exclusive or of
/// all edges, each mixed to a number that no few others add up to. One pass.
bool isClosedByIndex(const Mesh& mesh) {
  std::uint64_t odd = 0;
  forEdges(mesh, [&](VertexIndex a, VertexIndex b) { odd ^= base::mixBits(keyOf(a, b)); });
  return odd == 0;
}

}  // namespace

std::size_t countOpenEdges(const Mesh& mesh) {
  if (isClosedByIndex(mesh)) return 0;
  const std::vector<VertexIndex> names = namesByPlace(mesh);
  std::vector<std::uint64_t> edges;
  edges.reserve(4 * mesh.quads.size() + 3 * mesh.triangles.size());
  forEdges(mesh, [&](VertexIndex a, VertexIndex b) {
    if (names[a] != names[b]) edges.push_back(keyOf(names[a], names[b]));
  });
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
  printNote("note: the mesh is open: " + formatCount(open) +
            (open == 1 ? " edge belongs" : " edges belong") + " to one face only, and " + what +
            " is uncertain there; tufa repair --fill N fills holes of up to N edges");
}

}  // namespace tufa::tools
