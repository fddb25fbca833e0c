#include "refine/uniform_repair.h"

#include <algorithm>
#include <optional>

#include "refine/lone_samples.h"
#include "refine/order_along_creases.h"
#include "refine/rounding.h"
#include "refine/withdraw_placements.h"
#include "topology/misplaced.h"
#include "uniform/block_ranges.h"
#include "uniform/place_vertices.h"
#include "uniform/quads.h"

namespace tufa::refine {
namespace {

// How often misplaced components are put back.
constexpr int kMostPutBack = 3;
// Vertices of the largest component that may be passed. Vertices seldom move by more than three
// voxels; what they can pass as a whole lies in seven cells along each axis, of up to four vertices
// each.
constexpr std::size_t kMostSmall = 1400;
// Voxels from the end of a part of a grid to components that may go on behind it. Vertices stay
// nearer to their cells than that.
constexpr double kNearEnd = 8;

class UniformRepair {
 public:
  UniformRepair(uniform::UniformSurface& surface, ContourReport& report, base::Job& job)
      : surface_(surface), mesh_(surface.mesh), report_(report), job_(job) {}

  std::vector<intersect::PolygonPair> run() {
    const std::vector<LoneComponent> lone = findLoneComponents(mesh_, job_);
    const Source own = sourceOf(surface_, job_);
    report_.movedVertices = unfoldLoneComponents(mesh_, lone, own);
    report_.movedVertices += liftLoneComponents(mesh_, surface_.sheets, lone, own);
    margin_ = roundingMargin(surface_.volume);
    report_.movedVertices += orderAlongCreases(surface_, job_);
    Withdrawal withdrawn =
        withdrawPlacements(surface_, margin_, job_, [this] { return putBackComponents(); });
    report_.intersectionsFound = withdrawn.pairsFound;
    report_.movedVertices += withdrawn.vertices;
    pairs_ = std::move(withdrawn.pairs);
    if (pairs_.intersecting.empty()) return std::move(pairs_.close);
    repairPairs();
    for (int i = 0; i < kMostPutBack; ++i) {
      const std::vector<VertexIndex> misplaced = putBackComponents();
      if (misplaced.empty()) break;
      std::vector<std::uint8_t> marks(mesh_.positions.size(), 0);
      for (const VertexIndex vertex : misplaced) marks[vertex] = 1;
      findAgain(uniform::quadsAt(surface_.topology, mesh_, misplaced, marks, job_));
      repairPairs();
    }
    return std::move(pairs_.close);
  }

 private:
  void repairPairs() {
    Source own = sourceOf(surface_, job_);
    own.crossings = nullptr;  // the forest has no place for the centres of fans
    const RepairReport repaired =
        repairIntersections(mesh_, intersect::distinctPolygonsOf(pairs_.intersecting), own, job_);
    findAgain(repaired.changed);
    report_.intersectionsFound = std::max(report_.intersectionsFound, repaired.pairsFound);
    report_.intersectionsLeft = repaired.left.size();
    report_.movedVertices += repaired.movedVertices;
    report_.flippedDiagonals += repaired.flippedDiagonals;
  }

  // A vertex that a crease or the repair moved out of its cell may have passed a small component,
  // or lie in the plane of all others of one. Moves misplaced components and what is beside them,
  // and components that rounding may turn over, to their mass points. Returns the vertices that
  // moved, sorted.
  std::vector<VertexIndex> putBackComponents() {
    const uniform::CellTopology& cells = surface_.topology;
    if (surface_.sheets.sharpCount() == 0 || cells.openEdges > cells.missingEdges) return {};
    const std::optional<topology::OpenMesh> open = openMesh();
    const std::vector<VertexIndex> misplaced =
        topology::findMisplaced(mesh_, job_, kMostSmall, margin_, open ? &*open : nullptr);
    if (misplaced.empty()) return {};
    const std::vector<Position> fallbacks = sourceOf(surface_, job_).massPoints(misplaced);
    std::vector<VertexIndex> moved;
    for (std::size_t i = 0; i < misplaced.size(); ++i) {
      surface_.sheets.withdraw(misplaced[i]);
      if (mesh_.positions[misplaced[i]] == fallbacks[i]) continue;
      mesh_.positions[misplaced[i]] = fallbacks[i];
      moved.push_back(misplaced[i]);
    }
    report_.movedVertices += moved.size();
    return moved;
  }

  // What is known of the mesh of a part of a grid.
  [[nodiscard]] std::optional<topology::OpenMesh> openMesh() const {
    const grid::Blocks& blocks = surface_.volume.blocks;
    if (!blocks.isPart()) return std::nullopt;
    const grid::Slab slab = blocks.slab();
    return topology::OpenMesh{
        slab.axis, blocks.isInsideOutermost(), [this, slab](const Position& p) {
          const double at = surface_.affine().latticePoint(p, Coord(0))[slab.axis];
          return at < double(slab.first) + kNearEnd || at > double(slab.last) + 1 - kNearEnd;
        }};
  }

  // Looks for the pairs of quads, sorted, that have changed; all others are as before.
  void findAgain(const std::vector<intersect::PolygonIndex>& changed) {
    if (changed.empty()) return;
    const intersect::Surface surface(mesh_, job_);
    intersect::renewPairsOf(changed, intersect::findClosePairs(surface, changed, margin_, job_),
                            pairs_);
  }

  uniform::UniformSurface& surface_;
  Mesh& mesh_;
  ContourReport& report_;
  base::Job& job_;
  double margin_ = 0;  // twice the largest rounding
  intersect::ClosePairs pairs_;
};

}  // namespace

Source sourceOf(const uniform::UniformSurface& surface, base::Job& job) {
  Source source;
  source.massPoints = [&surface, &job](const std::vector<VertexIndex>& vertices) {
    return uniform::fallbackPoints(surface.volume.blocks, surface.volume.scale, surface.topology,
                                   surface.affine(), vertices, job)
        .mass;
  };
  source.crossings = [&surface, &job](const std::vector<intersect::PolygonIndex>& polygons) {
    return uniform::quadCrossings(surface.view(), polygons, job);
  };
  source.voxelSize = surface.affine().voxelSize();
  return source;
}

std::vector<intersect::PolygonPair> repairUniform(uniform::UniformSurface& surface,
                                                  ContourReport& report, base::Job& job) {
  return UniformRepair(surface, report, job).run();
}

}  // namespace tufa::refine
