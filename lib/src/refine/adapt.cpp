#include "refine/adapt.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/polygons.h"
#include "refine/split_cells.h"
#include "topology/misplaced.h"

namespace tufa::refine {
namespace {

// A mesh whose edges will be collapsed is cut at this share of the tolerance.
constexpr double kCutShare = 0.5;
// A mesh that is to have a number of triangles is cut with kLeastCut to kMostCut times as many, at
// a tolerance found in kMostSteps steps from kFirstTolerance, voxels. Edges are then collapsed at
// kFirstShare of that to begin with, or kLeastTolerance.
constexpr double kLeastCut = 2, kMostCut = 4;
constexpr int kMostSteps = 12;
constexpr double kFirstTolerance = 0.1;
constexpr double kFirstShare = 0.25;
constexpr double kLeastTolerance = 0.01;
// Cells along creases need far more triangles than collapsed edges: a cut at more than this is
// worse than what comes of collapsing a finer one.
constexpr double kMostTolerance = 0.25;
// Components are left out for a number of triangles up to so many times the size of the smallest.
constexpr double kDropStep = 2;

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

// The tolerance of a cut with two to four times so many triangles, found from the errors stored in
// the forest, without making a mesh; 0 if all cells together give no more.
double toleranceFor(std::size_t triangles, const octree::ClusterForest& forest,
                    const uniform::CellTopology& topology, octree::CutRule rule, base::Job& job) {
  const octree::CellFlags none(forest);
  const auto wanted = static_cast<double>(triangles);
  // A closed mesh has two triangles for each vertex.
  if (2.0 * static_cast<double>(topology.vertexCount) <= kLeastCut * wanted) return 0;
  double low = 0, high = 0;
  rule.tolerance = kFirstTolerance;
  for (int step = 0; step < kMostSteps; ++step) {
    const octree::CellFlags merged = octree::mergeCells(forest, rule, none, job);
    const auto found =
        2.0 * static_cast<double>(octree::makeCut(forest, topology, merged, job).clusters.size());
    if (found >= kLeastCut * wanted && found <= kMostCut * wanted) break;
    (found > kLeastCut * wanted ? low : high) = rule.tolerance;
    // On curved surfaces the number goes with the inverse of the tolerance.
    const double guess = rule.tolerance * found / (std::sqrt(kLeastCut * kMostCut) * wanted);
    const bool between = guess > low && (high == 0 || guess < high);
    rule.tolerance = between ? guess : (high > 0 ? 0.5 * (low + high) : 2 * low);
  }
  return rule.tolerance;
}

// Collapses edges, without the components that may be dropped.
Measured collapseRest(const uniform::SurfaceView& base, Measured mesh, octree::CutRule& rule,
                      const AdaptOptions& options, distance::Certifier& certifier,
                      std::vector<Dropped>& dropped, base::Job& job) {
  octree::CutRule sizes = rule;
  double next = options.drop ? dropComponents(base, sizes, mesh, dropped) : 0;
  if (!options.simplify) {
    if (!dropped.empty()) repairAndMeasure(certifier, options.repair, mesh, job);
    return mesh;
  }
  for (;;) {
    octree::CutRule own = rule;
    Measured collapsed = simplifyCut(base, mesh, own, options.goal, options.repair, certifier, job);
    const std::size_t count = collapsed.made.mesh.triangleCount();
    if (options.goal.triangles == 0 || count <= options.goal.triangles || next == 0) {
      rule = own;
      return collapsed;
    }
    sizes.tolerance = kDropStep * std::max(next, sizes.tolerance);
    next = dropComponents(base, sizes, mesh, dropped);
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
  adaptive.tolerance = rule.tolerance;
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
  extracted.candidates = std::move(mesh.candidates);
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
                   const AdaptOptions& options, base::Job& job, Measured* kept) {
  const uniform::SurfaceView base = model.view();
  const octree::ClusterForest& forest = model.forest();
  AdaptiveMesh adaptive;
  octree::CutRule cutRule = rule, last = rule;
  if (options.simplify) cutRule.tolerance *= kCutShare;
  if (options.simplify && options.goal.triangles > 0) {
    cutRule.tolerance = std::min(
        kMostTolerance, toleranceFor(options.goal.triangles, forest, base.topology, rule, job));
    last.tolerance = std::max(kFirstShare * cutRule.tolerance, kLeastTolerance);
  }
  distance::Certifier certifier(base, model.reference(), cutRule, job);
  Measured mesh = cutAndMeasure(base, forest, cutRule, options.repair, certifier, adaptive, job);
  mesh = collapseRest(base, std::move(mesh), last, options, certifier, adaptive.dropped, job);
  if (kept != nullptr) *kept = mesh;
  return finish(model, last, std::move(mesh), std::move(adaptive), job);
}

AdaptiveMesh coarsen(const SurfaceModel& model, const octree::CutRule& rule,
                     const AdaptOptions& options, base::Job& job, Measured& kept) {
  const uniform::SurfaceView base = model.view();
  AdaptiveMesh adaptive;
  octree::CutRule last = rule;
  distance::Certifier certifier(base, model.reference(), last, job);
  kept = collapseRest(base, std::move(kept), last, options, certifier, adaptive.dropped, job);
  adaptive.rounds = 1;
  return finish(model, last, kept, std::move(adaptive), job);
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

}  // namespace tufa::refine
