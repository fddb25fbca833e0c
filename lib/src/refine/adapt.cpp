#include "refine/adapt.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/huge_pages.h"
#include "base/polygons.h"
#include "base/small_angles.h"
#include "intersect/cut_candidates.h"
#include "intersect/surface.h"
#include "refine/cut_distance.h"
#include "refine/local_frame.h"
#include "refine/rounding.h"
#include "refine/split_cells.h"
#include "topology/misplaced.h"

namespace tufa::refine {
namespace {

// One in so many is few.
constexpr std::size_t kFew = 50;

std::vector<VertexIndex> baseVerticesOf(const octree::Cut& cut) {
  std::vector<VertexIndex> vertices;
  vertices.reserve(cut.clusters.size());
  for (const octree::ClusterRef& ref : cut.clusters) {
    vertices.push_back(ref.level == 0 ? ref.cluster : octree::kNone);
  }
  return vertices;
}

// Vertices - edges + faces. Edges are told apart at their lower ends, as the mesh may be open.
std::int64_t eulerCharacteristic(const Mesh& mesh, base::Job& job) {
  const std::size_t vertices = mesh.positions.size();
  const auto forEdges = [&](const auto& body) {
    base::forPolygons(mesh, [&](base::PolygonIndex polygon, base::Corners v) {
      job.pollCancelled(polygon);
      for (std::size_t i = 0; i < v.size(); ++i) {
        const VertexIndex a = v[i], b = v[i + 1 == v.size() ? 0 : i + 1];
        body(std::min(a, b), std::max(a, b));
      }
    });
  };
  std::vector<std::size_t> end(vertices + 1, 0);  // of the upper ends of each vertex's edges
  forEdges([&](VertexIndex low, VertexIndex) { ++end[low + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<VertexIndex> upper(end.back());
  forEdges([&](VertexIndex low, VertexIndex high) { upper[end[low]++] = high; });
  std::atomic<std::int64_t> edges{0};
  job.forRanges(vertices, base::kGrain, [&](std::size_t first, std::size_t last) {
    std::int64_t distinct = 0;
    for (std::size_t v = first; v < last; ++v) {
      const auto begin = upper.begin() + static_cast<std::ptrdiff_t>(v == 0 ? 0 : end[v - 1]);
      const auto stop = upper.begin() + static_cast<std::ptrdiff_t>(end[v]);
      std::sort(begin, stop);
      distinct += std::unique(begin, stop) - begin;
    }
    edges += distinct;
  });
  return static_cast<std::int64_t>(vertices) - edges +
         static_cast<std::int64_t>(mesh.triangles.size() + mesh.quads.size());
}

// The vertices of a cut that are not as in one before; without one, those of larger cells.
std::vector<std::uint8_t> changedVertices(const octree::Cut& before, const octree::Cut& cut) {
  std::vector<std::uint8_t> changed(cut.clusters.size());
  if (before.clusters.empty()) {
    for (std::size_t i = 0; i < changed.size(); ++i) changed[i] = cut.clusters[i].level != 0;
    return changed;
  }
  for (std::size_t i = 0; i < cut.vertexOf.size(); ++i) {
    const octree::ClusterRef& was = before.clusters[before.vertexOf[i]];
    const octree::ClusterRef& is = cut.clusters[cut.vertexOf[i]];
    if (was.level != is.level || was.cluster != is.cluster) changed[cut.vertexOf[i]] = 1;
  }
  return changed;
}

// Polygons of which each intersecting pair of a cut contains one: those at some vertices. The
// uniform mesh is free of pairs.
std::vector<intersect::PolygonIndex> polygonsAt(const Mesh& mesh,
                                                const std::vector<std::uint8_t>& vertices) {
  std::vector<intersect::PolygonIndex> polygons;
  base::forPolygons(mesh, [&](base::PolygonIndex polygon, base::Corners v) {
    if (std::any_of(v.begin(), v.end(), [&](VertexIndex k) { return vertices[k] != 0; })) {
      polygons.push_back(polygon);
    }
  });
  return polygons;
}

// Of the pairs of which one polygon is among `first` and one among `second`, and which intersect
// once the mesh is finished as finishMesh() does, the vertices. `first` is a list; `second` tells
// of each polygon, and is empty if it is all.
std::vector<VertexIndex> meetingVertices(const Mesh& mesh,
                                         const std::vector<intersect::PolygonIndex>& first,
                                         const std::vector<std::uint8_t>& second,
                                         const grid::Affine& affine, base::Job& job) {
  Mesh world;
  base::copyLarge(mesh.positions, world.positions, job);
  base::copyLarge(mesh.quads, world.quads, job);
  base::copyLarge(mesh.triangles, world.triangles, job);
  (void)takeToWorld(world, affine, job);
  const intersect::Surface surface(world, job);
  return intersect::verticesOf(
      world, intersect::polygonsOf(intersect::findPairs(
                 surface, first, job, [&](intersect::PolygonIndex a, intersect::PolygonIndex b) {
                   return second.empty() || second[a] != 0 || second[b] != 0;
                 })));
}

// Makes the coarsest cut found that keeps the rule.
class Cutter {
 public:
  Cutter(const SurfaceModel& model, const octree::CutRule& rule, base::Job& job)
      : model_(model),
        forest_(model.forest()),
        frame_(model.mesh().positions, model.affine().voxelSize(), job),
        rule_(withinFrame(rule)),
        job_(job),
        forbidden_(forest_),
        distance_(model.view(), frame_, rule_, job) {}

  AdaptiveMesh run(bool drop) {
    do {
      makeNext();
      ++adaptive_.rounds;
    } while (splitWhereNeeded());
    const uniform::SurfaceView base = model_.view();
    adaptive_.leaves = octree::collectLeaves(forest_, base.topology, merged_);
    if (drop) (void)dropComponents(base, rule_, cut_, made_, adaptive_.dropped);
    finish();
    return std::move(adaptive_);
  }

 private:
  [[nodiscard]] octree::CutRule withinFrame(octree::CutRule rule) const {
    rule.tolerance = frame_.within(rule.tolerance);
    return rule;
  }

  void makeNext() {
    const uniform::SurfaceView base = model_.view();
    made_ = {};
    takeCut(base.topology);
    made_ = octree::meshCut(forest_, cut_, base.mesh, base.affine, job_);
  }

  void takeCut(const uniform::CellTopology& topology) {
    const octree::Cut before = std::move(cut_);
    merged_ = octree::mergeCells(forest_, rule_, forbidden_, job_);
    cut_ = octree::makeCut(forest_, topology, merged_, job_);
    changed_ = changedVertices(before, cut_);
    if (unsearched_.empty()) return;
    for (std::size_t i = 0; i < unsearched_.size(); ++i) {
      unsearched_[i] |= changed_[cut_.vertexOf[i]];
    }
  }

  // The vertices of the cut that have changed since this was asked last.
  std::vector<std::uint8_t> changedSinceSearch() {
    if (unsearched_.empty()) {
      unsearched_.resize(cut_.vertexOf.size());
      return changedVertices({}, cut_);
    }
    std::vector<std::uint8_t> changed(cut_.clusters.size());
    for (std::size_t i = 0; i < unsearched_.size(); ++i) {
      changed[cut_.vertexOf[i]] |= std::exchange(unsearched_[i], 0);
    }
    return changed;
  }

  // Where few cells are too far off, intersections are looked for in the same round. Whether any
  // cell was split.
  bool splitWhereNeeded() {
    const std::vector<VertexIndex> coarse = distance_.measure(cut_, made_, changed_);
    const bool hasSplit = split(coarse);
    if (hasSplit && coarse.size() * kFew > cut_.clusters.size()) return true;
    if ((model_.repairs() && split(findMeeting())) || hasSplit) return true;
    return split(distance_.findUncovered(cut_, made_)) ||
           (model_.repairs() && split(findMisplaced()));
  }

  bool split(const std::vector<VertexIndex>& vertices) {
    return splitCells(forest_, vertices, cut_, rule_.minLevel, forbidden_);
  }

  std::vector<VertexIndex> findMeeting() {
    const std::vector<intersect::PolygonIndex> changed =
        polygonsAt(made_.mesh, changedSinceSearch());
    if (changed.size() * kFew < made_.mesh.quads.size() + made_.mesh.triangles.size())
      return meetingVertices(made_.mesh, changed, {}, model_.affine(), job_);
    const std::vector<std::uint8_t> isCandidate = intersect::findCutCandidates(
        forest_, cut_, made_, model_.view(), roundingMargin(model_.surface().volume), job_);
    std::vector<intersect::PolygonIndex> candidates;
    for (intersect::PolygonIndex i = 0; i < isCandidate.size(); ++i) {
      if (isCandidate[i] != 0) candidates.push_back(i);
    }
    // New pairs have a polygon that has changed, and a candidate. The fewer of them are searched.
    if (changed.size() <= candidates.size())
      return meetingVertices(made_.mesh, changed, isCandidate, model_.affine(), job_);
    std::vector<std::uint8_t> hasChanged(isCandidate.size(), 0);
    for (const intersect::PolygonIndex polygon : changed) hasChanged[polygon] = 1;
    return meetingVertices(made_.mesh, candidates, hasChanged, model_.affine(), job_);
  }

  std::vector<VertexIndex> findMisplaced() {
    if (model_.surface().topology.openEdges > 0) return {};
    return topology::findMisplaced(made_.mesh, job_);
  }

  void finish() {
    ExtractedMesh& extracted = adaptive_.extracted;
    // Cells that may not be split may intersect still.
    if (rule_.minLevel > 0 && model_.repairs()) {
      extracted.candidates = polygonsAt(made_.mesh, changedVertices({}, cut_));
    }
    extracted.baseVertices = baseVerticesOf(cut_);
    extracted.baseQuads = std::move(made_.quadSources);
    extracted.baseQuads.insert(extracted.baseQuads.end(), made_.triangleSources.begin(),
                               made_.triangleSources.end());
    const Deviation deviation = distance_.total(cut_, made_.mesh);
    adaptive_.largestError = deviation.largest + (deviation.largest > 0 ? frame_.rounding() : 0);
    adaptive_.meanError = deviation.mean;
    extracted.mesh = std::move(made_.mesh);
    (void)removeUnused(extracted.mesh, extracted.baseVertices);
  }

  const SurfaceModel& model_;
  const octree::ClusterForest& forest_;
  const LocalFrame frame_;
  const octree::CutRule rule_;
  base::Job& job_;
  octree::CellFlags forbidden_;
  octree::CellFlags merged_{forest_};
  CutDistance distance_;
  octree::Cut cut_;
  std::vector<std::uint8_t> changed_;     // of its vertices, since the cut before
  std::vector<std::uint8_t> unsearched_;  // of uniform vertices: changed since pairs were searched
  octree::CutMesh made_;
  AdaptiveMesh adaptive_;
};

}  // namespace

AdaptiveMesh adapt(const SurfaceModel& model, const octree::CutRule& rule, bool drop,
                   base::Job& job) {
  return Cutter(model, rule, job).run(drop);
}

void widen(Certificate& certificate, double moved, double voxelSize) {
  certificate.maxErrorVoxels += moved;
  certificate.maxErrorWorld += moved * voxelSize;
}

Certificate certificateOf(AdaptiveMesh& adaptive, double voxelSize, bool keepLeaves,
                          base::Job& job) {
  Certificate certificate;
  certificate.maxErrorVoxels = adaptive.largestError;
  certificate.meanErrorVoxels = adaptive.meanError;
  certificate.maxErrorWorld = adaptive.largestError * voxelSize;
  certificate.eulerCharacteristic = eulerCharacteristic(adaptive.extracted.mesh, job);
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
