#include "refine/adapt.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/polygons.h"
#include "base/small_angles.h"
#include "refine/split_cells.h"
#include "topology/misplaced.h"

namespace tufa::refine {
namespace {

std::vector<VertexIndex> baseVerticesOf(const octree::Cut& cut) {
  std::vector<VertexIndex> vertices;
  vertices.reserve(cut.clusters.size());
  for (const octree::ClusterRef& ref : cut.clusters) {
    vertices.push_back(ref.level == 0 ? ref.cluster : octree::kNone);
  }
  return vertices;
}

// Vertices - edges + faces. Edges are told apart by sorting, as the mesh may be open.
std::int64_t eulerCharacteristic(const Mesh& mesh) {
  std::vector<std::pair<VertexIndex, VertexIndex>> edges;
  edges.reserve(3 * mesh.triangles.size() + 4 * mesh.quads.size());
  base::forPolygons(mesh, [&](base::PolygonIndex, base::Corners v) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      const VertexIndex a = v[i], b = v[(i + 1) % v.size()];
      edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  });
  std::sort(edges.begin(), edges.end());
  const auto distinct = std::unique(edges.begin(), edges.end()) - edges.begin();
  return static_cast<std::int64_t>(mesh.positions.size()) - distinct +
         static_cast<std::int64_t>(mesh.triangles.size() + mesh.quads.size());
}

// The coarsest cut found that keeps the rule.
Measured cutAndMeasure(const uniform::SurfaceView& base, const octree::ClusterForest& forest,
                       const octree::CutRule& rule, const Repair* repair,
                       distance::Certifier& certifier, AdaptiveMesh& adaptive, base::Job& job) {
  octree::CellFlags forbidden(forest);
  for (adaptive.rounds = 1;; ++adaptive.rounds) {
    const octree::CellFlags merged = octree::mergeCells(forest, rule, forbidden, job);
    Measured mesh;
    mesh.cut = octree::makeCut(forest, base.topology, merged, job);
    mesh.made = octree::meshCut(forest, mesh.cut, base.mesh, base.affine, job);
    // Repair comes once the tolerance holds: there is less to repair then.
    mesh.deviation = certifier.measure(mesh.cut, mesh.made);
    if (splitCells(forest, tooCoarse(base.mesh, mesh.cut, mesh.deviation), mesh.cut, rule.minLevel,
                   forbidden))
      continue;
    repairAndMeasure(certifier, repair, mesh, job);
    bool split = splitCells(forest, tooCoarse(base.mesh, mesh.cut, mesh.deviation), mesh.cut,
                            rule.minLevel, forbidden);
    split |= splitCells(forest, mesh.meeting, mesh.cut, rule.minLevel, forbidden);
    if (split) continue;
    if (repair != nullptr && base.topology.openEdges == 0 &&
        splitCells(forest, topology::findMisplaced(mesh.made.mesh, job), mesh.cut, rule.minLevel,
                   forbidden)) {
      continue;
    }
    adaptive.leaves = octree::collectLeaves(forest, base.topology, merged);
    return mesh;
  }
}

// The share of uniform vertices and quads that a mesh stands for; the others count as without
// error.
double presentShare(const Mesh& base, const octree::Cut& cut, const std::vector<std::uint8_t>& used,
                    base::Job& job) {
  const auto isUsed = [&](VertexIndex vertex) { return used[cut.vertexOf[vertex]] != 0; };
  std::size_t count = 0;
  if (std::all_of(used.begin(), used.end(), [](std::uint8_t is) { return is != 0; })) return 1;
  for (std::size_t i = 0; i < base.positions.size(); ++i) {
    job.pollCancelled(i);
    count += isUsed(static_cast<VertexIndex>(i)) ? 1 : 0;
  }
  for (std::size_t i = 0; i < base.quads.size(); ++i) {
    job.pollCancelled(i);
    count += isUsed(base.quads[i].vertices[0]) ? 1 : 0;
  }
  const std::size_t all = base.positions.size() + base.quads.size();
  return count == 0 ? 1.0 : static_cast<double>(count) / static_cast<double>(all);
}

AdaptiveMesh finish(const SurfaceModel& model, const octree::CutRule& rule, Measured mesh,
                    AdaptiveMesh adaptive, base::Job& job) {
  adaptive.largestError = mesh.deviation.largest;
  adaptive.meanError = mesh.deviation.mean;
  if (!mesh.deviation.coarse.empty() || !mesh.deviation.farPoints.empty()) {
    // Cells that may not be split are off by more; what was kept from the meshes before is not in
    // this one's worst.
    distance::Certifier again(model.view(), model.reference(), rule, job);
    adaptive.largestError = again.measure(mesh.cut, mesh.made, mesh.altered).worst;
  }
  adaptive.repaired = std::move(mesh.repaired);
  ExtractedMesh& extracted = adaptive.extracted;
  // What is free of intersections need not be searched for them again.
  if (!adaptive.repaired.left.empty()) extracted.candidates = std::move(mesh.candidates);
  extracted.baseVertices = baseVerticesOf(mesh.cut);
  extracted.baseQuads = std::move(mesh.made.quadSources);
  extracted.baseQuads.insert(extracted.baseQuads.end(), mesh.made.triangleSources.begin(),
                             mesh.made.triangleSources.end());
  extracted.mesh = std::move(mesh.made.mesh);
  const std::vector<std::uint8_t> used = removeUnused(extracted.mesh, extracted.baseVertices);
  adaptive.meanError /= presentShare(model.mesh(), mesh.cut, used, job);
  return adaptive;
}

}  // namespace

AdaptiveMesh adapt(const SurfaceModel& model, const octree::CutRule& rule,
                   const AdaptOptions& options, base::Job& job) {
  const uniform::SurfaceView base = model.view();
  const octree::ClusterForest& forest = model.forest();
  AdaptiveMesh adaptive;
  distance::Certifier certifier(base, model.reference(), rule, job);
  Measured mesh = cutAndMeasure(base, forest, rule, options.repair, certifier, adaptive, job);
  if (options.drop) {
    (void)dropComponents(base, rule, mesh, adaptive.dropped);
    if (!adaptive.dropped.empty()) repairAndMeasure(certifier, options.repair, mesh, job);
  }
  return finish(model, rule, std::move(mesh), std::move(adaptive), job);
}

void widen(Certificate& certificate, double moved, double voxelSize) {
  certificate.maxErrorVoxels += moved;
  certificate.maxErrorWorld += moved * voxelSize;
}

Certificate certificateOf(AdaptiveMesh& adaptive, double voxelSize, bool keepLeaves) {
  Certificate certificate;
  certificate.maxErrorVoxels = adaptive.largestError;
  certificate.meanErrorVoxels = adaptive.meanError;
  certificate.maxErrorWorld = adaptive.largestError * voxelSize;
  certificate.eulerCharacteristic = eulerCharacteristic(adaptive.extracted.mesh);
  for (const LeafCell& leaf : adaptive.leaves) {
    const auto level = static_cast<std::size_t>(leaf.level);
    if (certificate.leafLevels.size() <= level) certificate.leafLevels.resize(level + 1);
    ++certificate.leafLevels[level];
  }
  if (keepLeaves) certificate.leaves = std::move(adaptive.leaves);
  certificate.rounds = adaptive.rounds;
  return certificate;
}

void setAngles(Certificate& certificate, const Mesh& mesh, double minAngle) {
  base::SmallAngles angles;
  angles.add(mesh.positions, triangulate(mesh), minAngle);
  certificate.smallestAngle = angles.smallest;
  certificate.trianglesUnderMinAngle = angles.below;
}

}  // namespace tufa::refine
