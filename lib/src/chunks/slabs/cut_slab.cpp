#include "chunks/slabs/cut_slab.h"

#include <algorithm>
#include <utility>

#include "base/huge_pages.h"
#include "base/ranked_bits.h"

namespace tufa::chunks {
namespace {

using Planes = std::array<std::uint32_t, 3>;

bool isAt(const ChunkPlane& plane, int axis, std::int32_t at) {
  return plane.axis == axis && plane.at == at;
}

class SlabCutter {
 public:
  SlabCutter(CutMesh whole, const grid::Slab& slab, base::Job& job)
      : whole_(std::move(whole)), slab_(slab), job_(job), left_(whole_.mesh.positions.size()) {}

  CutSlab run() {
    keepTriangles();
    keepVertices();
    out_.cut.planes = whole_.planes;
    for (std::size_t i = 0; i < whole_.onPlanes.size(); ++i) {
      job_.pollCancelled(i);
      if (left_.has(whole_.onPlanes[i])) keepPlanes(whole_.onPlanes[i], whole_.planesOf[i]);
    }
    finish(out_.lower), finish(out_.upper);
    return std::move(out_);
  }

 private:
  void keepTriangles() {
    CutMesh& cut = out_.cut;
    std::vector<std::uint32_t> numberOf(whole_.chunks.size(), ChunkPlane::kNone);
    for (std::size_t c = 0; c < numberOf.size(); ++c) {
      if (!slab_.contains(whole_.chunks[c])) continue;
      numberOf[c] = static_cast<std::uint32_t>(cut.chunks.size());
      cut.chunks.push_back(whole_.chunks[c]);
      cut.errors.push_back(whole_.errors[c]);
    }
    std::vector<Triangle>& triangles = whole_.mesh.triangles;
    std::vector<std::uint32_t> chunkOf;
    base::reserveLarge(chunkOf, triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      job_.pollCancelled(t);
      const std::uint32_t chunk = numberOf[whole_.chunkOf[t]];
      if (chunk == ChunkPlane::kNone) continue;
      for (const VertexIndex v : triangles[t].vertices) left_.add(v);
      triangles[chunkOf.size()] = triangles[t];
      chunkOf.push_back(chunk);
    }
    triangles.resize(chunkOf.size());
    left_.count();
    for (Triangle& t : triangles) {
      for (VertexIndex& v : t.vertices) v = left_.rank(v);
    }
    cut.mesh.triangles = std::move(triangles);
    cut.chunkOf = std::move(chunkOf);
  }

  void keepVertices() {
    const auto keep = [&](auto& from, auto& to) {
      if (from.empty()) return;
      std::size_t n = 0;
      left_.forAll([&](std::size_t v) { from[n++] = from[v]; });
      from.resize(n);
      to = std::move(from);
    };
    keep(whole_.mesh.positions, out_.cut.mesh.positions);
    keep(whole_.mesh.normals, out_.cut.mesh.normals);
  }

  // Those of a vertex but for the planes where the slab ends.
  void keepPlanes(VertexIndex v, const Planes& planes) {
    const VertexIndex now = left_.rank(v);
    SlabBorder* border = nullptr;
    Planes kept = {ChunkPlane::kNone, ChunkPlane::kNone, ChunkPlane::kNone};
    std::size_t count = 0;
    SlabBorder::Vertex vertex{{}, now, {ChunkPlane{-1, 0}, ChunkPlane{-1, 0}, ChunkPlane{-1, 0}}};
    for (std::size_t i = 0; i < planes.size() && planes[i] != ChunkPlane::kNone; ++i) {
      const ChunkPlane& plane = vertex.planes[i] = whole_.planes[planes[i]];
      if (isAt(plane, slab_.axis, slab_.first)) {
        border = &out_.lower;
      } else if (isAt(plane, slab_.axis, slab_.last + 1)) {
        border = &out_.upper;
      } else {
        kept[count++] = planes[i];
      }
    }
    if (border != nullptr) {
      const Position& p = out_.cut.mesh.positions[now];
      vertex.at = {p.x, p.y, p.z};
      border->vertices.push_back(vertex);
    }
    if (count == 0) return;
    out_.cut.onPlanes.push_back(now);
    out_.cut.planesOf.push_back(kept);
  }

  // Sorts the vertices, and finds the edges between them that one triangle has.
  void finish(SlabBorder& border) {
    std::sort(border.vertices.begin(), border.vertices.end(),
              [](const auto& a, const auto& b) { return a.at < b.at; });
    std::vector<std::pair<VertexIndex, std::uint32_t>> places;
    for (std::uint32_t i = 0; i < border.vertices.size(); ++i) {
      places.emplace_back(border.vertices[i].vertex, i);
    }
    std::sort(places.begin(), places.end());
    base::RankedBits isAt(out_.cut.mesh.positions.size());
    for (const auto& [v, place] : places) isAt.add(v);
    isAt.count();
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (std::size_t t = 0; t < out_.cut.mesh.triangles.size(); ++t) {
      job_.pollCancelled(t);
      const auto& v = out_.cut.mesh.triangles[t].vertices;
      for (std::size_t i = 0; i < 3; ++i) {
        const VertexIndex a = v[i], b = v[(i + 1) % 3];
        if (!isAt.has(a) || !isAt.has(b)) continue;
        edges.push_back({places[isAt.rank(a)].second, places[isAt.rank(b)].second});
      }
    }
    std::sort(edges.begin(), edges.end());
    for (const auto& [a, b] : edges) {
      if (!std::binary_search(edges.begin(), edges.end(), std::array{b, a})) {
        border.edges.push_back({a, b});
      }
    }
  }

  CutMesh whole_;
  grid::Slab slab_;
  base::Job& job_;
  base::RankedBits left_;  ///< the vertices that are kept
  CutSlab out_;
};

}  // namespace

bool fit(const SlabBorder& upper, const SlabBorder& lower) {
  const auto isSame = [](const SlabBorder::Vertex& a, const SlabBorder::Vertex& b) {
    return a.at == b.at && a.planes == b.planes;
  };
  if (!std::equal(upper.vertices.begin(), upper.vertices.end(), lower.vertices.begin(),
                  lower.vertices.end(), isSame) ||
      upper.edges.size() != lower.edges.size()) {
    return false;
  }
  return std::all_of(lower.edges.begin(), lower.edges.end(), [&](const auto& edge) {
    return std::binary_search(upper.edges.begin(), upper.edges.end(), std::array{edge[1], edge[0]});
  });
}

CutSlab takeSlab(CutMesh whole, const grid::Slab& slab, base::Job& job) {
  return SlabCutter(std::move(whole), slab, job).run();
}

}  // namespace tufa::chunks
