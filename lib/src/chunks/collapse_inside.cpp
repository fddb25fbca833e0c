#include "chunks/collapse_inside.h"

namespace tufa::chunks {

template <class TreeT>
SeamedCut collapseInside(const forest::Base<TreeT>& base, const SeamedCut& mesh, certify::Goal goal,
                         cut::CutRule rule, const certify::Repair* repair,
                         certify::Certifier<TreeT>& certifier, base::Job& job) {
  certify::Measured from;
  from.cut = mesh.cut;
  from.made = mesh.made;
  from.altered = mesh.altered;
  certify::Measured to = certify::simplifyCut(base, from, rule, goal, repair, certifier, job);
  SeamedCut result;
  result.cut = std::move(to.cut);
  result.made = std::move(to.made);
  // Vertices and triangles keep their order, and none on seams and in strips is lost.
  result.strips = mesh.strips;
  result.seamOf = mesh.seamOf;
  result.clusterCount =
      static_cast<VertexIndex>(result.made.mesh.positions.size() - result.seamOf.size());
  result.altered = std::move(to.altered);
  return result;
}

SeamedCut withInsideOf(const SeamedCut& mesh, const SeamedCut& to) {
  SeamedCut result;
  result.strips = mesh.strips;
  result.seamOf = mesh.seamOf;
  result.clusterCount = to.clusterCount;
  // A cluster by any of the base vertices that it stands for.
  const std::size_t baseVertices = mesh.cut.vertexOf.size();
  std::vector<VertexIndex> clusterOf(mesh.clusterCount);
  result.cut.vertexOf = to.cut.vertexOf;
  for (std::size_t i = 0; i < baseVertices; ++i) {
    const VertexIndex vertex = mesh.cut.vertexOf[i];
    if (mesh.isOnSeam(vertex)) {
      result.cut.vertexOf[i] = vertex - mesh.clusterCount + to.clusterCount;
    } else {
      clusterOf[vertex] = to.cut.vertexOf[i];
    }
  }
  const auto numberOf = [&](VertexIndex vertex) {
    return mesh.isOnSeam(vertex) ? vertex - mesh.clusterCount + to.clusterCount : clusterOf[vertex];
  };
  const auto append = [](auto& items, const auto& first, std::size_t count, const auto& second,
                         std::size_t begin) {
    items.assign(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(count));
    items.insert(items.end(), second.begin() + static_cast<std::ptrdiff_t>(begin), second.end());
  };
  append(result.cut.clusters, to.cut.clusters, to.clusterCount, mesh.cut.clusters,
         mesh.clusterCount);
  Mesh& own = result.made.mesh;
  const Mesh &inside = to.made.mesh, &seams = mesh.made.mesh;
  append(own.positions, inside.positions, to.clusterCount, seams.positions, mesh.clusterCount);
  append(own.normals, inside.normals, to.clusterCount, seams.normals, mesh.clusterCount);
  own.quads = inside.quads;
  result.made.quadSources = to.made.quadSources;
  const std::size_t insideCount = inside.triangles.size() - to.strips.size();
  const std::size_t firstStrip = seams.triangles.size() - mesh.strips.size();
  append(own.triangles, inside.triangles, insideCount, seams.triangles, firstStrip);
  append(result.made.triangleSources, to.made.triangleSources, insideCount,
         mesh.made.triangleSources, firstStrip);
  for (std::size_t i = insideCount; i < own.triangles.size(); ++i) {
    for (VertexIndex& vertex : own.triangles[i].vertices) vertex = numberOf(vertex);
  }
  for (const VertexIndex vertex : mesh.altered) result.altered.push_back(numberOf(vertex));
  for (const VertexIndex vertex : to.altered) {
    if (vertex < to.clusterCount) result.altered.push_back(vertex);
  }
  return result;
}

template SeamedCut collapseInside(const forest::Base<openvdb::FloatTree>&, const SeamedCut&,
                                  certify::Goal, cut::CutRule, const certify::Repair*,
                                  certify::Certifier<openvdb::FloatTree>&, base::Job&);
template SeamedCut collapseInside(const forest::Base<openvdb::DoubleTree>&, const SeamedCut&,
                                  certify::Goal, cut::CutRule, const certify::Repair*,
                                  certify::Certifier<openvdb::DoubleTree>&, base::Job&);

}  // namespace tufa::chunks
