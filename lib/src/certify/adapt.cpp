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
                   const cut::CutRule& rule, base::Job& job) {
  Certifier<TreeT> certifier(base, forest.levels[0], rule, job);
  cut::CellFlags forbidden(forest);
  for (int round = 1;; ++round) {
    const cut::CellFlags merged = cut::mergeCells(forest, base.topology, rule, forbidden, job);
    const cut::Cut cut = cut::makeCut(forest, base.topology, merged, job);
    polygons::CutMesh made = polygons::meshCut(forest, cut, base.mesh, base.affine, job);
    const Deviation deviation = certifier.measure(cut, made);
    if (!splitCells(deviation.coarse, cut, rule.minLevel, forbidden)) {
      double largest = deviation.largest;
      if (!deviation.coarse.empty()) {
        // Cells that may not be split are off by more; what was kept from the cuts before is not in
        // this one's worst.
        largest = Certifier<TreeT>(base, forest.levels[0], rule, job).measure(cut, made).worst;
      }
      return {std::move(made.mesh), cut::collectLeaves(forest, base.topology, merged), largest,
              deviation.mean, round};
    }
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
                            const cut::CutRule&, base::Job&);
template AdaptiveMesh adapt(const forest::Base<openvdb::DoubleTree>&, const forest::Forest&,
                            const cut::CutRule&, base::Job&);

}  // namespace tufa::certify
