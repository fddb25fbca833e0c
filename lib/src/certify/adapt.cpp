#include "certify/adapt.h"

#include <algorithm>
#include <utility>

namespace tufa::certify {
namespace {

// Forbids the cells of these vertices. Returns whether any could be split.
bool splitCells(const std::vector<VertexIndex>& vertices, const cut::Cut& cut, int minLevel,
                cut::CellFlags& forbidden) {
  bool any = false;
  for (const VertexIndex vertex : vertices) {
    const cut::ClusterRef& ref = cut.clusters[vertex];
    if (ref.level <= minLevel) continue;
    any = true;
    if (ref.level == 1) forbidden.level1[ref.parentCell] |= std::uint64_t{1} << ref.cell;
    if (ref.level == 2)
      forbidden.level2[ref.parentCell] |= static_cast<std::uint8_t>(1 << ref.cell);
    if (ref.level >= 3) forbidden.levels[ref.level - 3][ref.parentCell] = 1;
  }
  return any;
}

// The polygons that may meet others: the suspects of the base mesh that are left, and what is not
// of the base mesh.
std::vector<mend::PolygonIndex> suspectsOf(const polygons::CutMesh& made, const cut::Cut& cut,
                                           const std::vector<std::uint32_t>& baseSuspects) {
  std::vector<mend::PolygonIndex> suspects;
  for (std::size_t i = 0; i < made.mesh.quads.size(); ++i) {
    const auto& v = made.mesh.quads[i].vertices;
    const bool coarse =
        std::any_of(v.begin(), v.end(), [&](VertexIndex k) { return cut.clusters[k].level != 0; });
    if (coarse ||
        std::binary_search(baseSuspects.begin(), baseSuspects.end(), made.quadSources[i])) {
      suspects.push_back(static_cast<mend::PolygonIndex>(i));
    }
  }
  for (std::size_t i = 0; i < made.mesh.triangles.size(); ++i) {
    suspects.push_back(static_cast<mend::PolygonIndex>(made.mesh.quads.size() + i));
  }
  return suspects;
}

// Makes small changes to what is not of the base mesh; pairs that these do not help are left.
mend::MendReport mendCut(const Repair& repair, const cut::Cut& cut,
                         const std::vector<mend::PolygonIndex>& suspects, Mesh& mesh,
                         base::Job& job) {
  mend::Source source = repair.source;
  source.crossings = nullptr;
  source.toTheFloor = false;
  source.massPoints = [&](const std::vector<VertexIndex>& vertices) {
    std::vector<Position> points;
    for (const VertexIndex vertex : vertices) points.push_back(mesh.positions[vertex]);
    return points;
  };
  source.isFixed = [&](VertexIndex vertex) { return cut.clusters[vertex].level == 0; };
  return mend::mend(mesh, suspects, source, job);
}

// The vertices of some polygons, sorted.
std::vector<VertexIndex> verticesOf(const Mesh& mesh,
                                    const std::vector<mend::PolygonIndex>& polygons) {
  std::vector<VertexIndex> vertices;
  for (const mend::PolygonIndex polygon : polygons) {
    if (polygon < mesh.quads.size()) {
      const auto& v = mesh.quads[polygon].vertices;
      vertices.insert(vertices.end(), v.begin(), v.end());
    } else {
      const auto& v = mesh.triangles[polygon - mesh.quads.size()].vertices;
      vertices.insert(vertices.end(), v.begin(), v.end());
    }
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

std::vector<VertexIndex> baseVerticesOf(const cut::Cut& cut) {
  std::vector<VertexIndex> vertices;
  vertices.reserve(cut.clusters.size());
  for (const cut::ClusterRef& ref : cut.clusters) {
    vertices.push_back(ref.level == 0 ? ref.cluster : forest::kNone);
  }
  return vertices;
}

// Vertices - edges + faces. Edges are told apart by sorting, as the mesh may be open.
std::int64_t eulerCharacteristic(const Mesh& mesh) {
  std::vector<std::pair<VertexIndex, VertexIndex>> edges;
  edges.reserve(3 * mesh.triangles.size() + 4 * mesh.quads.size());
  const auto add = [&](const auto& vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const VertexIndex a = vertices[i], b = vertices[(i + 1) % vertices.size()];
      edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  };
  for (const Triangle& triangle : mesh.triangles) add(triangle.vertices);
  for (const Quad& quad : mesh.quads) add(quad.vertices);
  std::sort(edges.begin(), edges.end());
  const auto distinct = std::unique(edges.begin(), edges.end()) - edges.begin();
  return static_cast<std::int64_t>(mesh.positions.size()) - distinct +
         static_cast<std::int64_t>(mesh.triangles.size() + mesh.quads.size());
}

}  // namespace

template <class TreeT>
AdaptiveMesh adapt(const forest::Base<TreeT>& base, const forest::Forest& forest,
                   const cut::CutRule& rule, const Repair* repair, base::Job& job) {
  Certifier<TreeT> certifier(base, forest.levels[0], rule, job);
  cut::CellFlags forbidden(forest);
  AdaptiveMesh adaptive;
  for (adaptive.rounds = 1;; ++adaptive.rounds) {
    const cut::CellFlags merged = cut::mergeCells(forest, base.topology, rule, forbidden, job);
    const cut::Cut cut = cut::makeCut(forest, base.topology, merged, job);
    polygons::CutMesh made = polygons::meshCut(forest, cut, base.mesh, base.affine, job);
    Deviation deviation = certifier.measure(cut, made);
    if (splitCells(deviation.coarse, cut, rule.minLevel, forbidden)) continue;
    bool beyond = !deviation.coarse.empty();  // the tolerance, where cells may not be split
    std::vector<VertexIndex> altered;
    if (repair != nullptr) {
      adaptive.suspects = suspectsOf(made, cut, repair->suspects);
      adaptive.mended = mendCut(*repair, cut, adaptive.suspects, made.mesh, job);
      altered = verticesOf(made.mesh, adaptive.mended.changed);
      const Deviation after = certifier.measure(cut, made, altered);
      std::vector<VertexIndex> wanted = after.coarse;
      for (const auto& [a, b] : adaptive.mended.left) {
        const std::vector<VertexIndex> corners = verticesOf(made.mesh, {a, b});
        wanted.insert(wanted.end(), corners.begin(), corners.end());
      }
      if (splitCells(wanted, cut, rule.minLevel, forbidden)) continue;
      beyond |= !after.coarse.empty();
      deviation = after;
    }
    adaptive.largestError = deviation.largest;
    adaptive.meanError = deviation.mean;
    if (beyond) {
      // What was kept from the meshes before is not in this one's worst.
      Certifier<TreeT> again(base, forest.levels[0], rule, job);
      adaptive.largestError = again.measure(cut, made, altered).worst;
    }
    adaptive.leaves = cut::collectLeaves(forest, base.topology, merged);
    adaptive.baseVertices = baseVerticesOf(cut);
    adaptive.baseQuads = std::move(made.quadSources);
    adaptive.baseQuads.insert(adaptive.baseQuads.end(), made.triangleSources.begin(),
                              made.triangleSources.end());
    adaptive.mesh = std::move(made.mesh);
    return adaptive;
  }
}

Certificate certificateOf(AdaptiveMesh& adaptive, double voxelSize, bool keepLeaves) {
  Certificate certificate;
  certificate.maxErrorVoxels = adaptive.largestError;
  certificate.meanErrorVoxels = adaptive.meanError;
  certificate.maxErrorWorld = adaptive.largestError * voxelSize;
  certificate.eulerCharacteristic = eulerCharacteristic(adaptive.mesh);
  for (const LeafCell& leaf : adaptive.leaves) {
    const auto level = static_cast<std::size_t>(leaf.level);
    if (certificate.leafLevels.size() <= level) certificate.leafLevels.resize(level + 1);
    ++certificate.leafLevels[level];
  }
  if (keepLeaves) certificate.leaves = std::move(adaptive.leaves);
  certificate.rounds = adaptive.rounds;
  return certificate;
}

template AdaptiveMesh adapt(const forest::Base<openvdb::FloatTree>&, const forest::Forest&,
                            const cut::CutRule&, const Repair*, base::Job&);
template AdaptiveMesh adapt(const forest::Base<openvdb::DoubleTree>&, const forest::Forest&,
                            const cut::CutRule&, const Repair*, base::Job&);

}  // namespace tufa::certify
