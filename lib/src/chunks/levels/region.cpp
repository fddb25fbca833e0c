#include "chunks/levels/region.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/bits.h"
#include "chunks/levels/level_collapser.h"
#include "chunks/levels/level_repairer.h"
#include "chunks/levels/seamed_cut.h"
#include "chunks/levels/split_chunks.h"
#include "chunks/levels/strip_validation.h"
#include "chunks/seams/polyline.h"
#include "chunks/seams/seams.h"
#include "distance/certifier.h"
#include "intersect/surface.h"
#include "octree/build_forest.h"
#include "octree/leaves.h"
#include "refine/split_cells.h"

namespace tufa::chunks {
namespace {

// Share of the tolerance that a polyline may use on its face.
constexpr double kLineShare = 0.5;
// And never more than this, in voxels: where the surface is nearly flat on the face, what lies
// beside the polyline would be on its other side.
constexpr double kMostOff = 1.5;
// A polyline up to this far from its curve, in voxels, is near the uniform mesh beside it.
constexpr double kNearLine = 1;
// After so many rounds no more cells are split because of intersections: where there still are any,
// as on white noise, smaller cells do not help.
constexpr int kMostRounds = 12;
// Cells are merged at this share of the tolerance where edges will be collapsed.
constexpr double kCutShare = 0.5;

// The cell of each uniform vertex.
std::vector<Coord> cellsOf(const uniform::SurfaceView& base, base::Job& job) {
  std::vector<Coord> cells(base.topology.vertexCount);
  job.forRanges(base.topology.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const uniform::SurfaceBlock& block = base.topology.blocks[i];
      const Coord& origin = base.origin(i);
      std::uint64_t next = block.firstVertex;
      const uniform::CellException *exception = nullptr, *last = nullptr;
      if (block.special >= 0) {
        const auto& exceptions = base.topology.specials[block.special].exceptions;
        exception = exceptions.data();
        last = exception + exceptions.size();
      }
      for (int x = 0; x < grid::kBlockSize; ++x) {
        base::forEachBit(block.cells.slabs[x], [&](int bit) {
          int count = 1;
          if (exception != last && exception->cell == x * 64 + bit) count = (exception++)->count;
          for (; count > 0; --count) cells[next++] = origin.offsetBy(x, bit >> 3, bit & 7);
        });
      }
    }
  });
  return cells;
}

// Moves vertices that a crease drew beyond the faces of their chunk back into it; the crease is cut
// off there.
void keepInChunks(std::vector<Position>& positions, const std::vector<Coord>& cells,
                  const ChunkCells& chunks, const grid::Affine& affine, base::Job& job) {
  job.forRanges(positions.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 at = affine.latticePoint(positions[i], cells[i]);
      const Vec3 kept = chunks.keepInside(at, cells[i], cells[i]);
      if (kept != at) positions[i] = affine.position(cells[i], kept[0], kept[1], kept[2]);
    }
  });
}

// Forbids every cell in chunks that are not to be made.
octree::CellFlags forbidOthers(const octree::ClusterForest& forest, const ChunkCells& chunks) {
  octree::CellFlags forbidden(forest);
  for (const octree::ClusterLevel& level : forest.levels) {
    for (std::size_t i = 0; i < level.cells.size(); ++i) {
      const Coord chunk = level.cells[i] >> (chunks.level - level.level);
      if (!chunks.own.contains(chunk)) forbidden.at(level.level)[i] = 1;
    }
  }
  return forbidden;
}

class RegionMaker {
 public:
  RegionMaker(const refine::SurfaceModel& model, const ChunkCells& chunks,
              const RegionOptions& options, base::Job& job)
      : model_(model),
        chunks_(chunks),
        options_(options),
        job_(job),
        cells_(cellsOf(model.view(), job)),
        mesh_(inChunks(model.mesh())),
        base_(model.view().withMesh(mesh_)),
        forest_(octree::buildForest(base_, options.rule.maxLevel, options.rule.boundsAngle(), job)),
        before_(inChunks(model.meshBeforeRepair())),
        seams_(findSeams(base_, mesh_, before_, cells_, chunks, job)),
        seamPositions_(
            worldPositions(seams_, model.surface().volume.transform, options.singlePrecision)),
        seamBase_(model.view().withMesh(seams_.mesh)),
        surface_(seamBase_, forest_, job),
        repairer_({cells_, model.candidates(), seams_, seamPositions_, chunks, base_.affine,
                   options.singlePrecision},
                  job),
        forbidden_(forbidOthers(forest_, chunks)),
        beyond_(findBeyond()),
        collapser_({seamBase_, surface_, cells_, seams_, chunks, beyond_, repairer_}, job) {
    const StripValidation validation(before_, seams_, cells_, chunks, base_.affine, job);
    for (const double tolerance : options.tolerances) {
      const octree::CutRule rule = ruleFor(tolerance);
      const auto budget = [&](const Vec3& point) {
        return std::min(kMostOff, kLineShare * rule.toleranceAt(point)) * base_.affine.voxelSize();
      };
      PolylineValidation tried;
      if (options.repair) {
        tried = [&](std::size_t begin, std::size_t end) {
          return validation.ofFace(begin, end, kLineShare * tolerance > kNearLine);
        };
      }
      lines_.push_back(simplifySeams(seams_, base_.affine, budget, tried));
    }
  }

  [[nodiscard]] const std::vector<Coord>& cells() const { return cells_; }
  [[nodiscard]] const Seams& seams() const { return seams_; }
  [[nodiscard]] const std::vector<Position>& seamPositions() const { return seamPositions_; }
  [[nodiscard]] const SeamPolylines& lines(std::size_t level) const { return lines_[level]; }

  // One LOD: cut, divide at the seams, measure, repair, each time for both meshes, and start again
  // with smaller cells wherever either is too far or still intersects. After kMostRounds
  // intersections split no more cells; strips that still intersect run as their arcs do, and last
  // all but vertices on seams may move. It ends, as cells are only forbidden and flags only set.
  // Then edges are collapsed.
  LevelMeshes makeLevel(std::size_t level) {
    const octree::CutRule rule = ruleFor(options_.tolerances[level]);
    const octree::CutRule cutRule = ruleFor((options_.simplify ? kCutShare : 1) * rule.tolerance);
    const bool last = level + 1 == options_.tolerances.size();
    // If the next LOD has the same polylines, one mesh serves as both.
    const bool alone = last || lines_[level + 1] == lines_[level];
    octree::CellFlags forbidden = forbidden_;
    Certifier regular(seamBase_, surface_, cutRule, job_);
    regular.setIgnored(beyond_);
    std::optional<Certifier> transition;
    if (!alone) {
      transition.emplace(seamBase_, surface_, ruleFor(options_.tolerances[level + 1]), job_);
      transition->setIgnored(beyond_);
    }
    SideFlags direct, directNext;
    LevelRepairer::Clean clean;
    for (int round = 0;; ++round) {
      const octree::CellFlags merged = octree::mergeCells(forest_, cutRule, forbidden, job_);
      const octree::Cut cut = octree::makeCut(forest_, base_.topology, merged, job_);
      LevelMeshes meshes;
      meshes.regular = mesh(cut, lines_[level], direct);
      if (splitFar(meshes.regular, regular, forbidden)) continue;
      if (!alone) {
        meshes.transition = mesh(cut, lines_[level + 1], directNext);
        if (splitFar(meshes.transition, *transition, forbidden)) continue;
      }
      if (options_.repair) {
        repairer_.repairIntersections(meshes, alone, Movable::Clusters, clean);
        if (splitPairs(meshes, forbidden) && round < kMostRounds) continue;
        bool straightened = straighten(meshes.regular, meshes.pairs, direct);
        straightened |= straighten(meshes.transition, meshes.transitionPairs, directNext);
        if (straightened) continue;
        if (!meshes.pairs.empty() || !meshes.transitionPairs.empty()) {
          repairer_.repairIntersections(meshes, alone, Movable::All, clean);
        }
        bool split = splitFar(meshes.regular, regular, forbidden);
        if (!alone) split |= splitFar(meshes.transition, *transition, forbidden);
        if (split) continue;
      }
      const std::size_t next = level + (alone ? 0 : 1);
      const LevelCollapser::Level own{rule, options_.tolerances[next], lines_[next], alone};
      options_.simplify ? collapse(meshes, own, regular) : collapser_.measure(meshes, own);
      if (alone && !last) {
        meshes.transition = meshes.regular;
        meshes.transitionErrors = meshes.regularErrors;
        meshes.transitionPairs = meshes.pairs;
      }
      return meshes;
    }
  }

 private:
  using Certifier = distance::Certifier;

  [[nodiscard]] Mesh inChunks(Mesh mesh) {
    keepInChunks(mesh.positions, cells_, chunks_, model_.affine(), job_);
    return mesh;
  }

  // Uniform quads with a vertex and their middle in chunks that are not made.
  [[nodiscard]] std::vector<std::uint8_t> findBeyond() const {
    std::vector<std::uint8_t> beyond(mesh_.quads.size(), 0);
    const auto isOwn = [&](const Coord& cell) {
      return chunks_.own.contains(chunks_.chunkOf(cell));
    };
    for (std::size_t i = 0; i < beyond.size(); ++i) {
      const auto& v = mesh_.quads[i].vertices;
      if (std::all_of(v.begin(), v.end(), [&](VertexIndex k) { return isOwn(cells_[k]); })) {
        continue;
      }
      const Position &p = mesh_.positions[v[0]], &q = mesh_.positions[v[2]];
      const Position middle(0.5 * (p.x + q.x), 0.5 * (p.y + q.y), 0.5 * (p.z + q.z));
      const Coord& from = cells_[v[0]];
      const Vec3 at = base_.affine.latticePoint(middle, from);
      beyond[i] = isOwn(from + floorCoord(at)) ? 0 : 1;
    }
    return beyond;
  }

  [[nodiscard]] octree::CutRule ruleFor(double tolerance) const {
    octree::CutRule rule = options_.rule;
    rule.tolerance = tolerance;
    return rule;
  }

  [[nodiscard]] SeamedCut mesh(const octree::Cut& cut, const SeamPolylines& lines,
                               const SideFlags& direct) {
    return meshWithSeams(forest_, cut, seams_, lines, cells_, chunks_, base_.affine, direct, job_);
  }

  bool splitFar(const SeamedCut& mesh, Certifier& certifier, octree::CellFlags& forbidden) {
    const distance::Deviation deviation = certifier.measure(mesh.cut, mesh.made, mesh.altered);
    return refine::splitCells(forest_, refine::tooCoarse(seams_.mesh, mesh.cut, deviation),
                              mesh.cut, options_.rule.minLevel, forbidden);
  }

  // Where splitting cells does not help, strips that intersect others run as their arcs do, like
  // the uniform mesh. Whether there are any.
  bool straighten(const SeamedCut& mesh, const std::vector<intersect::PolygonPair>& pairs,
                  SideFlags& direct) const {
    const std::size_t firstStrip = mesh.firstStripPolygon();
    direct.resize(2 * seams_.curves.size(), 0);
    bool any = false;
    for (const intersect::PolygonIndex polygon : intersect::polygonsOf(pairs)) {
      if (polygon < firstStrip) continue;
      std::uint8_t& flag = direct[mesh.strips[polygon - firstStrip].number()];
      any |= flag == 0;
      flag = 1;
    }
    return any;
  }

  // Splits the cells of polygons that intersect. Whether there are any.
  bool splitPairs(const LevelMeshes& meshes, octree::CellFlags& forbidden) {
    bool split = splitPairs(meshes.regular, meshes.pairs, forbidden);
    split |= splitPairs(meshes.transition, meshes.transitionPairs, forbidden);
    std::vector<intersect::PolygonIndex> regular, transition;
    for (const auto& [a, b] : meshes.mixedPairs) {
      regular.push_back(a);
      transition.push_back(b);
    }
    split |= splitAround(meshes.regular, regular, forbidden);
    split |= splitAround(meshes.transition, transition, forbidden);
    return split;
  }

  bool splitPairs(const SeamedCut& mesh, const std::vector<intersect::PolygonPair>& pairs,
                  octree::CellFlags& forbidden) {
    return splitAround(mesh, intersect::polygonsOf(pairs), forbidden);
  }

  bool splitAround(const SeamedCut& mesh, const std::vector<intersect::PolygonIndex>& polygons,
                   octree::CellFlags& forbidden) {
    return refine::splitCells(forest_, intersect::verticesOf(mesh.made.mesh, polygons), mesh.cut,
                              options_.rule.minLevel, forbidden);
  }

  void collapse(LevelMeshes& meshes, const LevelCollapser::Level& level, Certifier& certifier) {
    const auto repair = model_.repair(job_);
    collapser_.collapse(meshes, level, repair ? &*repair : nullptr, certifier);
  }

  const refine::SurfaceModel& model_;
  const ChunkCells& chunks_;
  const RegionOptions& options_;
  base::Job& job_;
  std::vector<Coord> cells_;  ///< of the uniform vertices
  Mesh mesh_;                 ///< the uniform mesh, all vertices in their chunks
  uniform::SurfaceView base_;
  octree::ClusterForest forest_;
  Mesh before_;  ///< mesh_ before its repair
  Seams seams_;
  std::vector<Position> seamPositions_;  ///< in the world
  uniform::SurfaceView seamBase_;        ///< with the seams' vertices
  distance::UniformReference surface_;
  LevelRepairer repairer_;
  std::vector<SeamPolylines> lines_;  ///< of each LOD
  octree::CellFlags forbidden_;
  std::vector<std::uint8_t> beyond_;
  LevelCollapser collapser_;
};

}  // namespace

std::vector<MadeChunk> makeRegion(const refine::SurfaceModel& model, const ChunkCells& chunks,
                                  const RegionOptions& options, base::Job& job) {
  if (model.mesh().positions.empty()) return {};
  RegionMaker maker(model, chunks, options, job);
  ChunkSplitter splitter(maker.cells(), maker.seams(), maker.seamPositions(), chunks,
                         model.affine(), options.singlePrecision);
  for (std::size_t level = 0; level < options.tolerances.size(); ++level) {
    const bool last = level + 1 == options.tolerances.size();
    splitter.addLevel(maker.makeLevel(level), maker.lines(level),
                      last ? nullptr : &maker.lines(level + 1));
  }
  return splitter.takeChunks();
}

}  // namespace tufa::chunks
