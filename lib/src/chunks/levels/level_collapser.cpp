#include "chunks/levels/level_collapser.h"

#include <algorithm>
#include <utility>

#include "base/polygons.h"
#include "chunks/levels/seam_rim.h"
#include "topology/dilate.h"

namespace tufa::chunks {
namespace {

// Tries at most, each without what went wrong and twice as far around it.
constexpr int kMostTries = 4;
// A collapse that saves less than this share of the triangles is not worth its time.
constexpr double kLeastSaved = 0.05;

}  // namespace

// Marks vertices in chunks to be made.
std::vector<std::uint8_t> LevelCollapser::findOwn(const SeamedCut& mesh) const {
  std::vector<std::uint8_t> own(mesh.cut.clusters.size(), 0);
  for (std::size_t i = 0; i < region_.cells.size(); ++i) {
    const Coord chunk = region_.chunks.chunkOf(region_.cells[i]);
    if (region_.chunks.own.contains(chunk)) own[mesh.cut.vertexOf[i]] = 1;
  }
  return own;
}

// Marks what must stay, and limits the rest to its chunk.
refine::Goal LevelCollapser::goalFor(const SeamedCut& mesh,
                                     std::vector<std::uint8_t>& fixed) const {
  const std::vector<std::uint8_t> own = findOwn(mesh);
  fixed.assign(own.size(), 0);
  for (std::size_t i = 0; i < own.size(); ++i) fixed[i] = own[i] == 0 ? 1 : 0;
  refine::Goal goal;
  goal.rim = rimOf(mesh, region_.seams, fixed);

  std::vector<Coord> cellOf(mesh.clusterCount);
  for (std::size_t i = 0; i < region_.cells.size(); ++i) {
    cellOf[mesh.cut.vertexOf[i]] = region_.cells[i];
  }
  goal.mayLie = [this, cellOf = std::move(cellOf)](VertexIndex vertex, const Vec3& point) {
    const Coord& cell = cellOf[vertex];
    const Vec3 at = region_.base.affine.latticePoint({point[0], point[1], point[2]}, cell);
    return region_.chunks.keepInside(at, cell, cell) == at;
  };

  std::size_t count = 0;
  const auto isOwn = [&](VertexIndex vertex) { return own[vertex] != 0; };
  base::forPolygons(mesh.made.mesh, [&](base::PolygonIndex, base::Corners v) {
    if (std::any_of(v.begin(), v.end(), isOwn)) count += v.size() - 2;
  });
  goal.giveUp = mesh.made.mesh.triangleCount() -
                static_cast<std::size_t>(kLeastSaved * static_cast<double>(count));
  return goal;
}

// Collapses the regular mesh; the transition mesh takes over its interior. Both are repaired and
// measured, and if neither is worse than before they replace the old ones.
void LevelCollapser::collapse(LevelMeshes& meshes, const Level& level, const refine::Repair* repair,
                              distance::Certifier& certifier) const {
  std::vector<std::uint8_t> fixed;
  refine::Goal goal = goalFor(meshes.regular, fixed);
  fixEars(meshes.regular, fixed);
  if (!level.alone) fixEars(meshes.transition, fixed);
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    goal.fixed.clear();
    for (VertexIndex i = 0; i < fixed.size(); ++i) {
      if (fixed[i] != 0) goal.fixed.push_back(i);
    }
    LevelMeshes next;
    next.regular = collapse(meshes.regular, goal, level.rule, repair, certifier);
    if (next.regular.made.mesh.triangleCount() >= goal.giveUp) break;
    keepInChunks(region_.cells, region_.chunks, region_.base.affine, next.regular);
    if (!level.alone) {
      next.transition = withStripsOf(meshes.transition, next.regular, region_.seams,
                                     level.nextLines, region_.chunks);
    }
    LevelRepairer::Clean clean;
    if (repair != nullptr)
      region_.repairer.repairIntersections(next, level.alone, Movable::Clusters, clean);
    measure(next, level);
    std::vector<std::uint8_t> worse = findWorse(meshes, next, level);
    if (std::find(worse.begin(), worse.end(), 1) == worse.end()) {
      meshes = std::move(next);
      return;
    }
    worse = topology::dilate(next.regular.made.mesh, std::move(worse), 1 << attempt);
    for (std::size_t i = 0; i < region_.cells.size(); ++i) {
      if (worse[next.regular.cut.vertexOf[i]] != 0) fixed[meshes.regular.cut.vertexOf[i]] = 1;
    }
  }
  measure(meshes, level);
}

SeamedCut LevelCollapser::collapse(const SeamedCut& mesh, const refine::Goal& goal,
                                   octree::CutRule rule, const refine::Repair* repair,
                                   distance::Certifier& certifier) const {
  refine::Measured from;
  from.cut = mesh.cut;
  from.made = mesh.made;
  from.altered = mesh.altered;
  refine::Measured to =
      refine::simplifyCut(region_.base, from, rule, goal, repair, certifier, job_);
  SeamedCut result;
  result.cut = std::move(to.cut);
  result.made = std::move(to.made);
  result.seamOf = mesh.seamOf;
  result.clusterCount =
      static_cast<VertexIndex>(result.made.mesh.positions.size() - result.seamOf.size());
  result.altered = std::move(to.altered);
  // Vertices and triangles keep their order.
  for (const StripLeft& left : stripsLeft(mesh, result.cut)) {
    result.strips.push_back(mesh.strips[left.strip]);
  }
  return result;
}

// Marks vertices of pairs, if there are more pairs than before, and those with an error above the
// tolerance and above all errors before.
std::vector<std::uint8_t> LevelCollapser::findWorse(LevelMeshes& before, const LevelMeshes& now,
                                                    const Level& level) const {
  std::vector<std::uint8_t> worse(now.regular.cut.clusters.size(), 0);
  const auto mark = [&](const SeamedCut& mesh,
                        const std::vector<intersect::PolygonIndex>& polygons) {
    for (const VertexIndex vertex : intersect::verticesOf(mesh.made.mesh, polygons)) {
      if (!mesh.isOnSeam(vertex)) worse[vertex] = 1;
    }
  };
  const auto look = [&](const SeamedCut& mesh, const std::vector<intersect::PolygonPair>& pairs,
                        const std::vector<intersect::PolygonPair>& pairsBefore,
                        const std::vector<float>& errors, const std::vector<float>& errorsBefore,
                        double tolerance) {
    if (pairs.size() > pairsBefore.size()) mark(mesh, intersect::polygonsOf(pairs));
    auto most = static_cast<float>(tolerance);
    if (std::all_of(errors.begin(), errors.end(), [&](float error) { return error <= most; })) {
      return;
    }
    measure(before, level);
    most = std::max(most, *std::max_element(errorsBefore.begin(), errorsBefore.end()));
    for (VertexIndex i = 0; i < mesh.clusterCount; ++i) {
      if (errors[i] > most) worse[i] = 1;
    }
  };
  look(now.regular, now.pairs, before.pairs, now.regularErrors, before.regularErrors,
       level.rule.tolerance);
  if (!level.alone) {
    look(now.transition, now.transitionPairs, before.transitionPairs, now.transitionErrors,
         before.transitionErrors, level.nextTolerance);
  }
  if (now.mixedPairs.size() > before.mixedPairs.size()) {
    for (const auto& [a, b] : now.mixedPairs) {
      mark(now.regular, {a});
      mark(now.transition, {b});
    }
  }
  return worse;
}

void LevelCollapser::measure(LevelMeshes& meshes, const Level& level) const {
  // A new Certifier, as one in use also reports errors of earlier meshes.
  const auto errorsOf = [&](const SeamedCut& mesh, std::vector<float>& errors) {
    if (!errors.empty()) return;
    distance::Certifier certifier(region_.base, region_.surface, level.rule, job_);
    certifier.setIgnored(region_.beyond);
    (void)certifier.measure(mesh.cut, mesh.made, mesh.altered);
    errors = certifier.errorsAtVertices();
  };
  errorsOf(meshes.regular, meshes.regularErrors);
  if (!level.alone) errorsOf(meshes.transition, meshes.transitionErrors);
}

}  // namespace tufa::chunks
