#include "extract/sharp_loops.h"

#include <algorithm>
#include <optional>

#include "base/huge_pages.h"
#include "extract/cell_walk.h"
#include "extract/crease_point.h"
#include "extract/loop_crossings.h"
#include "extract/sheets_of_cell.h"

namespace tufa::extraction {

using uniform::SurfaceBlock;

namespace {

class LoopSharpener {
 public:
  LoopSharpener(const grid::Volume& volume, const CubeCells& cells, const Mesh& mesh,
                double leastCosine, base::Job& job)
      : volume_(volume), cells_(cells), mesh_(mesh), leastCosine_(leastCosine), job_(job) {}

  SharpLoops run() {
    findSharp();
    placeFeatures();
    return std::move(found_);
  }

 private:
  // Finds the loops whose normals differ enough.
  void findSharp() {
    planes_.resize(cells_.topology.blocks.size());
    base::resizeLarge(sharp_, cells_.topology.cellCount, job_);
    walkCells(cells_, job_, [&](const WalkedCell& cell) {
      std::vector<uniform::Qef>& planes = planes_[cell.place.block];
      CellFeatures& sharp = sharp_[cell.place.cell];
      sharp.first = static_cast<VertexIndex>(planes.size());
      for (int loop = 0; loop < cell.cubeCase().loopCount; ++loop) {
        const LoopCrossings crossings = crossingsOf(cell, loop);
        if (crossings.leastCosine() >= leastCosine_) continue;
        sharp.add(loop);
        planes.push_back(planesOf(cell, crossings));
      }
    });
  }

  void placeFeatures() {
    found_.blocks.resize(cells_.topology.blocks.size());
    base::resizeLarge(found_.cells, cells_.topology.cellCount, job_);
    job_.forRanges(found_.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      CubeTable table;
      SheetsOfCell sheets(volume_);
      for (std::size_t i = begin; i < end; ++i) {
        const SurfaceBlock& block = cells_.topology.blocks[i];
        // Outside of distance fields planes are not exact enough to follow them.
        const bool follows = volume_.scale.distance && isNearSharp(block);
        if (planes_[i].empty() && !follows) continue;
        sheets.moveTo(block);
        walkBlock(cells_, i, table,
                  [&](const WalkedCell& cell) { placeFeatures(cell, follows, sheets); });
      }
    });
  }

  void placeFeatures(const WalkedCell& cell, bool follows, SheetsOfCell& sheets) {
    std::vector<LoopFeature>& own = found_.blocks[cell.place.block];
    CellFeatures& features = found_.cells[cell.place.cell];
    const CellFeatures& sharp = sharp_[cell.place.cell];
    features.first = static_cast<VertexIndex>(own.size());
    for (int loop = 0; loop < cell.cubeCase().loopCount; ++loop) {
      if (!sharp.has(loop) && !follows) continue;
      const LoopCrossings crossings = crossingsOf(cell, loop);
      const auto placed = sharp.has(loop) ? placeAt(cell, loop, sheets)
                                          : creaseThrough(cell, loop, crossings, sheets);
      if (!placed) continue;
      features.add(loop);
      own.push_back(
          {featureAt(placed->point, cell.corner(volume_.blocks), crossings, volume_.affine),
           *placed});
    }
  }

  [[nodiscard]] LoopCrossings crossingsOf(const WalkedCell& cell, int loop) const {
    return {cell.cubeCase(), loop, cell.tablePlace(), cell.table, mesh_};
  }
  [[nodiscard]] uniform::Qef planesOf(const WalkedCell& cell,
                                      const LoopCrossings& crossings) const {
    return crossings.planes(volume_.affine, cell.corner(volume_.blocks));
  }

  [[nodiscard]] std::optional<uniform::CreasePlacement> placeAt(const WalkedCell& cell, int loop,
                                                                SheetsOfCell& sheets) const {
    const uniform::Qef& planes = planes_[cell.place.block][sharp_[cell.place.cell].of(loop)];
    uniform::CreasePlacement placed;
    if (!volume_.scale.distance) {
      placed.point = uniform::solve(planes, CreasePoint::kHalfCell);
      return placed;
    }
    if (auto found = sheets.at(cell.at, planes.massPoint())) return found;
    // A crease may leave the cell and come back.
    const CreasePoint best(planes);
    placed.point = best.isInside ? best.inside : best.beyond;
    return placed;
  }

  // Whether a loop of a block, or of one beside it, has normals that differ enough.
  [[nodiscard]] bool isNearSharp(const SurfaceBlock& block) const {
    constexpr std::array<std::array<int, 3>, 7> kSteps = {
        {{0, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
    return std::any_of(kSteps.begin(), kSteps.end(), [&](const std::array<int, 3>& step) {
      const auto index = cells_.topology.neighbour(block, step[0], step[1], step[2]);
      return index != uniform::kNoSurfaceBlock && !planes_[index].empty();
    });
  }

  // A crease may clip a cell whose own crossings all lie on one sheet. The loops beyond its arcs
  // tell of the other: where the sheets meet in this cell there is a vertex, too.
  [[nodiscard]] std::optional<uniform::CreasePlacement> creaseThrough(
      const WalkedCell& cell, int loop, const LoopCrossings& crossings,
      SheetsOfCell& sheets) const {
    std::optional<uniform::Qef> planes;
    forLoop(cell.cubeCase(), loop, [&](int edge) {
      const LoopBeyond beyond = loopBeyond(cells_, cell, edge);
      if (beyond.loop < 0 || !sharp_[beyond.place.cell].has(beyond.loop)) return;
      if (!planes) planes = planesOf(cell, crossings);
      uniform::Vector here{};
      here[beyond.face / 2] = (beyond.face & 1) != 0 ? -1.0F : 1.0F;
      const VertexIndex index = sharp_[beyond.place.cell].of(beyond.loop);
      *planes += planes_[beyond.place.block][index].seenFrom(here);
    });
    if (!planes) return std::nullopt;
    // Along the crease the vertex is nearest to the crossings of this loop.
    const uniform::Qef own = planesOf(cell, crossings);
    for (int i = 0; i < 3; ++i) planes->points[i] = own.points[i] * planes->count / own.count;
    if (!CreasePoint::mayBeInside(*planes)) return std::nullopt;
    auto found = sheets.at(cell.at, own.massPoint());
    if (found && !found->outOfCell) return found;
    const CreasePoint best(*planes);
    if (!best.isInside) return std::nullopt;
    uniform::CreasePlacement placed;
    placed.point = best.inside;
    return placed;
  }

  const grid::Volume& volume_;
  const CubeCells& cells_;
  const Mesh& mesh_;
  double leastCosine_;
  base::Job& job_;
  SharpLoops found_;
  std::vector<CellFeatures> sharp_;                ///< of each surface cell: loops with planes
  std::vector<std::vector<uniform::Qef>> planes_;  ///< of each surface block
};

}  // namespace

SharpLoops findSharpLoops(const grid::Volume& volume, const CubeCells& cells, const Mesh& mesh,
                          double leastCosine, base::Job& job) {
  return LoopSharpener(volume, cells, mesh, leastCosine, job).run();
}

}  // namespace tufa::extraction
