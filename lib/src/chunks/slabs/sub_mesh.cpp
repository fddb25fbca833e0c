#include "chunks/slabs/sub_mesh.h"

#include <algorithm>
#include <functional>

#include "base/huge_pages.h"
#include "base/parallel_sort.h"
#include "base/ranked_bits.h"

namespace tufa::chunks {
namespace {

// The vertices at which several borders of the marked triangles begin, sorted.
std::vector<VertexIndex> pinchedVertices(const CutMesh& mesh,
                                         const std::vector<std::uint8_t>& marks, base::Job& job) {
  const auto keyOf = [](VertexIndex a, VertexIndex b) { return std::uint64_t{a} << 32 | b; };
  std::vector<std::uint64_t> edges;
  for (std::size_t t = 0; t < marks.size(); ++t) {
    job.pollCancelled(t);
    if (marks[t] == 0) continue;
    const auto& v = mesh.mesh.triangles[t].vertices;
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(keyOf(v[i], v[(i + 1) % 3]));
  }
  base::parallelSort(edges.begin(), edges.end(), std::less<>());
  std::vector<VertexIndex> begins, pinched;  // of edges of one triangle, in the order of vertices
  for (std::size_t i = 0; i < edges.size(); ++i) {
    job.pollCancelled(i);
    const auto a = static_cast<VertexIndex>(edges[i] >> 32);
    const auto b = static_cast<VertexIndex>(edges[i]);
    if (!std::binary_search(edges.begin(), edges.end(), keyOf(b, a))) begins.push_back(a);
  }
  for (std::size_t i = 1; i < begins.size(); ++i) {
    if (begins[i] == begins[i - 1]) pinched.push_back(begins[i]);
  }
  return pinched;
}

}  // namespace

void keepManifold(const CutMesh& mesh, std::vector<std::uint8_t>& marks, base::Job& job) {
  for (;;) {
    const std::vector<VertexIndex> pinched = pinchedVertices(mesh, marks, job);
    if (pinched.empty()) return;
    for (std::size_t t = 0; t < marks.size(); ++t) {
      job.pollCancelled(t);
      if (marks[t] == 0) continue;
      const auto& v = mesh.mesh.triangles[t].vertices;
      const bool isPinched = std::any_of(v.begin(), v.end(), [&](VertexIndex corner) {
        return std::binary_search(pinched.begin(), pinched.end(), corner);
      });
      if (isPinched) marks[t] = 0;
    }
  }
}

SubMesh subMesh(const CutMesh& mesh, const std::vector<std::uint8_t>& isWanted, base::Job& job) {
  SubMesh sub;
  CutMesh& cut = sub.cut;
  cut.chunks = mesh.chunks, cut.planes = mesh.planes;
  cut.moved = mesh.moved, cut.isSeparated = mesh.isSeparated;
  const auto count = static_cast<std::size_t>(std::count_if(
      isWanted.begin(), isWanted.end(), [](std::uint8_t wanted) { return wanted != 0; }));
  base::RankedBits used(mesh.mesh.positions.size());
  base::reserveLarge(sub.triangles, count);
  for (std::uint32_t t = 0; t < isWanted.size(); ++t) {
    job.pollCancelled(t);
    if (isWanted[t] == 0) continue;
    sub.triangles.push_back(t);
    for (const VertexIndex v : mesh.mesh.triangles[t].vertices) used.add(v);
  }
  used.count();
  base::reserveLarge(sub.vertices, used.size());
  used.forAll([&](std::size_t v) { sub.vertices.push_back(static_cast<VertexIndex>(v)); });
  const auto take = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    base::resizeLarge(to, sub.vertices.size(), job);
    job.forRanges(to.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) to[i] = from[sub.vertices[i]];
    });
  };
  take(mesh.mesh.positions, cut.mesh.positions), take(mesh.mesh.normals, cut.mesh.normals);
  take(mesh.reference, cut.reference), take(mesh.isNew, cut.isNew);
  std::vector<std::uint32_t> chunkOf;
  base::resizeLarge(chunkOf, count, job), base::resizeLarge(cut.mesh.triangles, count, job);
  job.forRanges(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& v = mesh.mesh.triangles[sub.triangles[i]].vertices;
      cut.mesh.triangles[i] = {used.rank(v[0]), used.rank(v[1]), used.rank(v[2])};
      chunkOf[i] = mesh.chunkOf[sub.triangles[i]];
    }
  });
  cut.chunkOf = std::move(chunkOf);
  for (std::size_t i = 0; i < mesh.onPlanes.size(); ++i) {
    job.pollCancelled(i);
    if (!used.has(mesh.onPlanes[i])) continue;
    cut.onPlanes.push_back(used.rank(mesh.onPlanes[i]));
    cut.planesOf.push_back(mesh.planesOf[i]);
  }
  for (const auto& [v, by] : mesh.movedAt) {
    if (used.has(v)) cut.movedAt.push_back({used.rank(v), by});
  }
  return sub;
}

}  // namespace tufa::chunks
