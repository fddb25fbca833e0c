#include "refine/collapse/partition.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace tufa::refine {
namespace {

// An extent counts as longer if it is so by this factor: a mesh that is translated, and so rounded
// otherwise, is divided alike.
constexpr double kLonger = 1.0625;
// Parts with fewer vertices are not worth a thread.
constexpr std::size_t kWorthAThread = std::size_t{1} << 15;

int longestAxis(const EdgeMesh& mesh, std::span<const VertexIndex> vertices) {
  Vec3 low = mesh.point(vertices.front()), high = low;
  for (const VertexIndex vertex : vertices) {
    low = minVec3(low, mesh.point(vertex));
    high = maxVec3(high, mesh.point(vertex));
  }
  const Vec3 extent = high - low;
  int longest = 0;
  for (const int axis : {1, 2}) {
    if (extent[axis] > kLonger * extent[longest]) longest = axis;
  }
  return longest;
}

// Divides vertices as a k-d tree does. Ties are broken by place, and the second half is appended
// after the first, so neither the order of the mesh nor the threads matter.
void part(const EdgeMesh& mesh, std::span<VertexIndex> vertices, std::size_t most, Parting parting,
          std::vector<std::span<VertexIndex>>& regions) {
  if (vertices.size() <= most) {
    regions.push_back(vertices);
    return;
  }
  const int axis = longestAxis(mesh, vertices);
  const std::size_t first = parting == Parting::Halves ? vertices.size() / 2 : vertices.size() / 3;
  std::nth_element(vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(first),
                   vertices.end(), [&](VertexIndex a, VertexIndex b) {
                     const double x = mesh.point(a)[axis], y = mesh.point(b)[axis];
                     return x < y || (x == y && mesh.isBefore(a, b));
                   });
  const std::span<VertexIndex> before = vertices.first(first), rest = vertices.subspan(first);
  if (vertices.size() < kWorthAThread) {
    part(mesh, before, most, parting, regions);
    part(mesh, rest, most, parting, regions);
    return;
  }
  std::vector<std::span<VertexIndex>> behind;
  base::runBoth([&] { part(mesh, before, most, parting, regions); },
                [&] { part(mesh, rest, most, parting, behind); });
  regions.insert(regions.end(), behind.begin(), behind.end());
}

}  // namespace

Regions makeRegions(const EdgeMesh& mesh, std::size_t most, Parting parting, base::Job& job) {
  std::vector<VertexIndex> roots;
  for (const VertexIndex vertex : mesh.byPlace()) {
    if (mesh.isRoot(vertex)) roots.push_back(vertex);
  }
  if (roots.size() <= most) return oneRegion(mesh);
  std::vector<std::span<VertexIndex>> parts;
  part(mesh, roots, most, parting, parts);
  Regions regions;
  regions.of.assign(mesh.vertexCount(), kNone);
  regions.inner.assign(mesh.vertexCount(), 1);
  regions.vertices.resize(parts.size());
  job.forRanges(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<VertexIndex>& own = regions.vertices[i];
      own.assign(parts[i].begin(), parts[i].end());
      std::sort(own.begin(), own.end(),
                [&](VertexIndex a, VertexIndex b) { return mesh.isBefore(a, b); });
      for (const VertexIndex vertex : own) regions.of[vertex] = static_cast<std::uint32_t>(i);
    }
  });
  for (std::size_t t = 0; t < mesh.cornerCount(); t += 3) {
    job.pollCancelled(t);
    if (!mesh.isAlive(t)) continue;
    const std::array<VertexIndex, 3> v = {mesh.corner(t), mesh.corner(t + 1), mesh.corner(t + 2)};
    if (regions.of[v[0]] == regions.of[v[1]] && regions.of[v[0]] == regions.of[v[2]]) continue;
    for (const VertexIndex vertex : v) regions.inner[vertex] = 0;
  }
  return regions;
}

Regions oneRegion(const EdgeMesh& mesh) {
  Regions regions;
  regions.of.assign(mesh.vertexCount(), 0);
  regions.inner.assign(mesh.vertexCount(), 1);
  regions.vertices.resize(1);
  for (const VertexIndex vertex : mesh.byPlace()) {
    if (mesh.isRoot(vertex)) regions.vertices[0].push_back(vertex);
  }
  return regions;
}

}  // namespace tufa::refine
