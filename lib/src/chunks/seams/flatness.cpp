#include "chunks/seams/flatness.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tufa::chunks {
namespace {

// Steps around an arc that are searched: no more than the margin around the chunks allows.
constexpr int kRings = 5;

using Edge = std::pair<VertexIndex, VertexIndex>;

// The edges of the uniform mesh within kRings steps of any arc, in both directions, sorted.
std::vector<Edge> edgesNear(const Mesh& base, const std::vector<Arc>& arcs) {
  std::vector<std::uint8_t> near(base.positions.size(), 0);
  for (const Arc& arc : arcs) near[arc.below] = near[arc.above] = 1;
  // Marks grow by a ring at a time, edges are kept where both ends are marked.
  for (int ring = 0; ring < kRings; ++ring) {
    std::vector<std::uint8_t> wider = near;
    for (const Quad& quad : base.quads) {
      const auto& v = quad.vertices;
      for (int i = 0; i < 4; ++i) {
        if (near[v[i]] != 0) wider[v[(i + 1) % 4]] = wider[v[(i + 3) % 4]] = 1;
      }
    }
    near = std::move(wider);
  }
  std::vector<Edge> edges;
  for (const Quad& quad : base.quads) {
    const auto& v = quad.vertices;
    for (int i = 0; i < 4; ++i) {
      const VertexIndex a = v[i], b = v[(i + 1) % 4];
      if (near[a] != 0 && near[b] != 0) edges.insert(edges.end(), {{a, b}, {b, a}});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

void measureFlatness(const Mesh& base, const Mesh& before, const grid::Affine& affine,
                     Seams& seams) {
  const std::vector<Edge> edges = edgesNear(base, seams.arcs);
  std::vector<std::uint32_t> seen(base.positions.size(), kNoSeam);
  for (SeamIndex i = 0; i < seams.arcs.size(); ++i) {
    Arc& arc = seams.arcs[i];
    const SeamVertex& vertex = seams.vertices[i];
    const Position at =
        affine.position(vertex.cell, vertex.offset[0], vertex.offset[1], vertex.offset[2]);
    const Vec3 point(at.x, at.y, at.z);
    const Vec3 normal(vertex.normal.x, vertex.normal.y, vertex.normal.z);
    std::vector<VertexIndex> found = {arc.below, arc.above};
    std::size_t begin = 0;
    double worst = 0;
    seen[arc.below] = seen[arc.above] = i;
    for (int ring = 0; ring <= kRings; ++ring) {
      const std::size_t end = found.size();
      for (; begin < end; ++begin) {
        const VertexIndex from = found[begin];
        const Position& p = before.positions[from];
        worst = std::max(worst, std::abs(normal.dot(Vec3(p) - point)));
        if (ring == kRings) continue;
        auto edge = std::lower_bound(edges.begin(), edges.end(), Edge(from, 0));
        for (; edge != edges.end() && edge->first == from; ++edge) {
          if (seen[edge->second] == i) continue;
          seen[edge->second] = i;
          found.push_back(edge->second);
        }
      }
      for (std::size_t k = 0; k < arc.flatness.size(); ++k) {
        if (ring == std::min(1 << k, kRings)) arc.flatness[k] = static_cast<float>(worst);
      }
    }
  }
}

}  // namespace tufa::chunks
