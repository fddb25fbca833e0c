#include "refine/repair_rounded.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "base/ranked_bits.h"
#include "base/single_precision.h"
#include "refine/repair/repair.h"
#include "refine/rounding.h"
#include "refine/uniform_repair.h"
#include "uniform/block_ranges.h"

namespace tufa::refine {
namespace {

using intersect::PolygonIndex;
using intersect::PolygonPair;

// Some quads of the uniform mesh as they will be written, with numbers of their own. These rise
// with those of the mesh, so that whatever goes by the order of polygons goes on as in the whole.
class WrittenPart {
 public:
  WrittenPart(const uniform::UniformSurface& surface, std::vector<PolygonIndex> quads,
              bool isSingle)
      : quads_(std::move(quads)), used_(surface.mesh.positions.size()) {
    for (const PolygonIndex quad : quads_) {
      for (const VertexIndex v : surface.mesh.quads[quad].vertices) used_.add(v);
    }
    used_.count();
    vertices_.reserve(used_.size()), mesh_.positions.reserve(used_.size());
    used_.forAll([&](std::size_t v) {
      const Position world = surface.affine().toWorld(surface.mesh.positions[v]);
      vertices_.push_back(static_cast<VertexIndex>(v));
      mesh_.positions.push_back(isSingle ? base::toSingle(world) : world);
    });
    mesh_.quads.reserve(quads_.size());
    for (const PolygonIndex quad : quads_) {
      const auto& v = surface.mesh.quads[quad].vertices;
      mesh_.quads.emplace_back(used_.rank(v[0]), used_.rank(v[1]), used_.rank(v[2]),
                               used_.rank(v[3]));
    }
  }

  [[nodiscard]] Mesh& mesh() { return mesh_; }
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] VertexIndex vertexOf(VertexIndex own) const { return vertices_[own]; }
  [[nodiscard]] PolygonIndex quadOf(PolygonIndex own) const { return quads_[own]; }
  /// The own number of a quad.
  [[nodiscard]] PolygonIndex find(PolygonIndex quad) const {
    return static_cast<PolygonIndex>(std::lower_bound(quads_.begin(), quads_.end(), quad) -
                                     quads_.begin());
  }

 private:
  std::vector<PolygonIndex> quads_;  // rising
  base::RankedBits used_;
  std::vector<VertexIndex> vertices_;  // rising
  Mesh mesh_;
};

class RoundedRepair {
 public:
  RoundedRepair(uniform::UniformSurface& surface, base::Job& job)
      : surface_(surface),
        job_(job),
        isSingle_(isWrittenInSingle(surface.mesh.positions, surface.affine(), job)) {}

  RepairReport run(const std::vector<PolygonPair>& closePairs) {
    const std::vector<PolygonIndex> candidates = findIntersecting(closePairs);
    if (candidates.empty()) return {};
    const std::vector<std::uint8_t> isInside = markAround(candidates);
    WrittenPart part(surface_, quadsAtMarked(isInside), isSingle_);
    Source source = sourceOf(surface_, job_);
    source.massPoints = [&, points = source.massPoints](std::vector<VertexIndex> vertices) {
      for (VertexIndex& v : vertices) v = part.vertexOf(v);
      std::vector<Position> all = points(vertices);
      for (Position& point : all) point = surface_.affine().toWorld(point);
      return all;
    };
    source.crossings = nullptr;
    source.isFixed = [&](VertexIndex v) { return isInside[part.vertexOf(v)] == 0; };
    source.singlePrecision = isSingle_;
    source.wholeSize = surface_.mesh.quads.size();
    std::vector<PolygonIndex> own;
    for (const PolygonIndex quad : candidates) own.push_back(part.find(quad));
    RepairReport repaired = repairIntersections(part.mesh(), own, source, job_);
    takeBack(part, repaired);
    return repaired;
  }

 private:
  // The quads of those pairs that intersect as they will be written, rising.
  [[nodiscard]] std::vector<PolygonIndex> findIntersecting(
      const std::vector<PolygonPair>& closePairs) const {
    const WrittenPart part(surface_, intersect::distinctPolygonsOf(closePairs), isSingle_);
    std::vector<PolygonPair> pairs;
    pairs.reserve(closePairs.size());
    for (const auto& [a, b] : closePairs) pairs.push_back({part.find(a), part.find(b)});
    std::vector<PolygonIndex> found = intersect::distinctPolygonsOf(
        intersect::intersectingAmong(pairs, part.mesh(), part.mesh().positions, job_));
    for (PolygonIndex& quad : found) quad = part.quadOf(quad);
    return found;
  }

  // Marks the vertices of the blocks of some quads and of all blocks around them: a repair moves
  // vertices by a voxel or so, far from a border that is eight voxels away.
  [[nodiscard]] std::vector<std::uint8_t> markAround(const std::vector<PolygonIndex>& quads) const {
    const uniform::CellTopology& topology = surface_.topology;
    std::vector<std::uint8_t> isInside(surface_.mesh.positions.size(), 0);
    const std::vector<VertexIndex> vertices = intersect::verticesOf(surface_.mesh, quads);
    for (const uniform::BlockRange& range : uniform::blocksOfVertices(topology, vertices)) {
      for (int place = 0; place < 27; ++place) {
        const uniform::SurfaceBlockIndex block = topology.neighbour(
            topology.blocks[range.block], place / 9 - 1, place / 3 % 3 - 1, place % 3 - 1);
        if (block == uniform::kNoSurfaceBlock) continue;
        const std::uint64_t end = block + 1 < topology.blocks.size()
                                      ? topology.blocks[block + 1].firstVertex
                                      : topology.vertexCount;
        for (auto v = topology.blocks[block].firstVertex; v < end; ++v) isInside[v] = 1;
      }
    }
    return isInside;
  }

  [[nodiscard]] std::vector<PolygonIndex> quadsAtMarked(
      const std::vector<std::uint8_t>& marks) const {
    std::vector<VertexIndex> marked;
    for (std::size_t v = 0; v < marks.size(); ++v) {
      if (marks[v] != 0) marked.push_back(static_cast<VertexIndex>(v));
    }
    return uniform::quadsAt(surface_.topology, surface_.mesh, marked, marks, job_);
  }

  void takeBack(const WrittenPart& part, const RepairReport& repaired) {
    Mesh& mesh = surface_.mesh;
    for (const auto& [vertex, from] : repaired.moved) {
      mesh.positions[part.vertexOf(vertex)] =
          surface_.affine().fromWorld(part.mesh().positions[vertex]);
    }
    for (const PolygonIndex quad : repaired.changed) {
      const auto& own = part.mesh().quads[quad].vertices;
      auto& vertices = mesh.quads[part.quadOf(quad)].vertices;
      for (std::size_t i = 0; i < 4; ++i) vertices[i] = part.vertexOf(own[i]);
    }
  }

  uniform::UniformSurface& surface_;
  base::Job& job_;
  bool isSingle_;
};

}  // namespace

void repairRounded(uniform::UniformSurface& surface, const std::vector<PolygonPair>& closePairs,
                   ContourReport& report, base::Job& job) {
  RepairReport repaired;
  if (!closePairs.empty()) repaired = RoundedRepair(surface, job).run(closePairs);
  report.movedVertices += repaired.movedVertices;
  report.flippedDiagonals += repaired.flippedDiagonals;
  report.intersectionsLeft = repaired.left.size();
}

}  // namespace tufa::refine
