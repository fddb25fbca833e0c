#include "certify/adapt.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "certify/split_cells.h"
#include "mend/pieces.h"

namespace tufa::certify {
namespace {

// A mesh that will be simplified is cut at this share of the tolerance.
constexpr double kCutShare = 0.5;
// One that is to have so many triangles is cut with so many times as many, at a tolerance found in
// so many steps from a first one, voxels. Collapsing begins with a share of it, or the least one.
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

// The coarsest cut found that keeps the rule.
template <class TreeT>
Measured cutAndMeasure(const forest::Base<TreeT>& base, const forest::Forest& forest,
                       const cut::CutRule& rule, const Repair* repair, Certifier<TreeT>& certifier,
                       AdaptiveMesh& adaptive, base::Job& job) {
  cut::CellFlags forbidden(forest);
  for (adaptive.rounds = 1;; ++adaptive.rounds) {
    const cut::CellFlags merged = cut::mergeCells(forest, base.topology, rule, forbidden, job);
    Measured mesh;
    mesh.cut = cut::makeCut(forest, base.topology, merged, job);
    mesh.made = polygons::meshCut(forest, mesh.cut, base.mesh, base.affine, job);
    // Mending comes once the tolerance holds: there is less to mend then.
    mesh.deviation = certifier.measure(mesh.cut, mesh.made);
    if (splitCells(tooCoarse(base.mesh, mesh.cut, mesh.deviation), mesh.cut, rule.minLevel,
                   forbidden))
      continue;
    mendAndMeasure(certifier, repair, mesh, job);
    bool split = splitCells(tooCoarse(base.mesh, mesh.cut, mesh.deviation), mesh.cut, rule.minLevel,
                            forbidden);
    split |= splitCells(mesh.meeting, mesh.cut, rule.minLevel, forbidden);
    if (split) continue;
    if (repair != nullptr && base.topology.cutEdges == 0 &&
        splitCells(mend::findMisplaced(mesh.made.mesh, job), mesh.cut, rule.minLevel, forbidden)) {
      continue;
    }
    adaptive.leaves = cut::collectLeaves(forest, base.topology, merged);
    return mesh;
  }
}

// The tolerance of a cut of between two and four times so many triangles, found on the errors that
// the forest has stored; 0 if all cells together have no more.
double toleranceFor(std::size_t triangles, const forest::Forest& forest,
                    const components::Topology& topology, cut::CutRule rule, base::Job& job) {
  const cut::CellFlags none(forest);
  const auto wanted = static_cast<double>(triangles);
  // A closed mesh has two triangles for each vertex.
  if (2.0 * static_cast<double>(topology.vertexCount) <= kLeastCut * wanted) return 0;
  double low = 0, high = 0;
  rule.tolerance = kFirstTolerance;
  for (int step = 0; step < kMostSteps; ++step) {
    const cut::CellFlags merged = cut::mergeCells(forest, topology, rule, none, job);
    const auto found =
        2.0 * static_cast<double>(cut::makeCut(forest, topology, merged, job).clusters.size());
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
template <class TreeT>
Measured collapseRest(const forest::Base<TreeT>& base, Measured mesh, cut::CutRule& rule,
                      const AdaptOptions& options, Certifier<TreeT>& certifier,
                      std::vector<Dropped>& dropped, base::Job& job) {
  cut::CutRule sizes = rule;
  double next = options.drop ? dropComponents(base, sizes, mesh, dropped) : 0;
  if (!options.simplify) {
    if (!dropped.empty()) mendAndMeasure(certifier, options.repair, mesh, job);
    return mesh;
  }
  for (;;) {
    cut::CutRule own = rule;
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

// The share of base vertices and quads that a mesh stands for; the others count as without error.
double presentShare(const Mesh& base, const cut::Cut& cut, const std::vector<std::uint8_t>& used,
                    base::Job& job) {
  const auto isUsed = [&](VertexIndex vertex) { return used[cut.vertexOf[vertex]] != 0; };
  std::size_t count = 0;
  if (std::all_of(used.begin(), used.end(), [](std::uint8_t is) { return is != 0; })) return 1;
  for (std::size_t i = 0; i < base.positions.size(); ++i) {
    job.lookAtTimes(i);
    count += isUsed(static_cast<VertexIndex>(i)) ? 1 : 0;
  }
  for (std::size_t i = 0; i < base.quads.size(); ++i) {
    job.lookAtTimes(i);
    count += isUsed(base.quads[i].vertices[0]) ? 1 : 0;
  }
  const std::size_t all = base.positions.size() + base.quads.size();
  return count == 0 ? 1.0 : static_cast<double>(count) / static_cast<double>(all);
}

template <class TreeT>
AdaptiveMesh finish(const forest::Base<TreeT>& base, const BaseSurface<TreeT>& surface,
                    const cut::CutRule& rule, Measured mesh, AdaptiveMesh adaptive,
                    base::Job& job) {
  adaptive.tolerance = rule.tolerance;
  adaptive.largestError = mesh.deviation.largest;
  adaptive.meanError = mesh.deviation.mean;
  if (!mesh.deviation.coarse.empty() || !mesh.deviation.farPoints.empty()) {
    // Cells that may not be split are off by more; what was kept from the meshes before is not in
    // this one's worst.
    Certifier<TreeT> again(base, surface, rule, job);
    adaptive.largestError = again.measure(mesh.cut, mesh.made, mesh.altered).worst;
  }
  adaptive.mended = std::move(mesh.mended);
  adaptive.suspects = std::move(mesh.suspects);
  adaptive.baseVertices = baseVerticesOf(mesh.cut);
  adaptive.baseQuads = std::move(mesh.made.quadSources);
  adaptive.baseQuads.insert(adaptive.baseQuads.end(), mesh.made.triangleSources.begin(),
                            mesh.made.triangleSources.end());
  adaptive.mesh = std::move(mesh.made.mesh);
  const std::vector<std::uint8_t> used = removeUnused(adaptive.mesh, adaptive.baseVertices);
  adaptive.meanError /= presentShare(base.mesh, mesh.cut, used, job);
  return adaptive;
}

}  // namespace

template <class TreeT>
AdaptiveMesh adapt(const forest::Base<TreeT>& base, const forest::Forest& forest,
                   const BaseSurface<TreeT>& surface, const cut::CutRule& rule,
                   const AdaptOptions& options, base::Job& job, Measured* kept) {
  AdaptiveMesh adaptive;
  cut::CutRule cutRule = rule, last = rule;
  if (options.simplify) cutRule.tolerance *= kCutShare;
  if (options.simplify && options.goal.triangles > 0) {
    cutRule.tolerance = std::min(
        kMostTolerance, toleranceFor(options.goal.triangles, forest, base.topology, rule, job));
    last.tolerance = std::max(kFirstShare * cutRule.tolerance, kLeastTolerance);
  }
  Certifier<TreeT> certifier(base, surface, cutRule, job);
  Measured mesh = cutAndMeasure(base, forest, cutRule, options.repair, certifier, adaptive, job);
  mesh = collapseRest(base, std::move(mesh), last, options, certifier, adaptive.dropped, job);
  if (kept != nullptr) *kept = mesh;
  return finish(base, surface, last, std::move(mesh), std::move(adaptive), job);
}

template <class TreeT>
AdaptiveMesh coarsen(const forest::Base<TreeT>& base, const BaseSurface<TreeT>& surface,
                     const cut::CutRule& rule, const AdaptOptions& options, base::Job& job,
                     Measured& kept) {
  AdaptiveMesh adaptive;
  cut::CutRule last = rule;
  Certifier<TreeT> certifier(base, surface, last, job);
  kept = collapseRest(base, std::move(kept), last, options, certifier, adaptive.dropped, job);
  adaptive.rounds = 1;
  return finish(base, surface, last, kept, std::move(adaptive), job);
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
                            const BaseSurface<openvdb::FloatTree>&, const cut::CutRule&,
                            const AdaptOptions&, base::Job&, Measured*);
template AdaptiveMesh coarsen(const forest::Base<openvdb::FloatTree>&,
                              const BaseSurface<openvdb::FloatTree>&, const cut::CutRule&,
                              const AdaptOptions&, base::Job&, Measured&);
template AdaptiveMesh adapt(const forest::Base<openvdb::DoubleTree>&, const forest::Forest&,
                            const BaseSurface<openvdb::DoubleTree>&, const cut::CutRule&,
                            const AdaptOptions&, base::Job&, Measured*);
template AdaptiveMesh coarsen(const forest::Base<openvdb::DoubleTree>&,
                              const BaseSurface<openvdb::DoubleTree>&, const cut::CutRule&,
                              const AdaptOptions&, base::Job&, Measured&);

}  // namespace tufa::certify
