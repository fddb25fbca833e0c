#include "extract/sharp_loops.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/huge_pages.h"
#include "extract/cell_walk.h"
#include "extract/crease_point.h"
#include "extract/loop_crossings.h"
#include "extract/sheets_of_cell.h"

namespace tufa::extraction {

using uniform::SurfaceBlock;

namespace {

// Whether the crease at a point of a cell passes another one, whose middle is counted from the same
// place. A corner's creases may.
bool mayPass(const uniform::CreasePlacement& crease, const uniform::Vector& cell) {
  constexpr float kHalf = 0.55F;
  if (crease.planes != 2) return crease.planes > 2;
  const uniform::Vector &a = crease.sheets[0], &b = crease.sheets[1];
  const uniform::Vector way = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                               a[0] * b[1] - a[1] * b[0]};
  float from = -std::numeric_limits<float>::infinity(), to = -from;
  for (int axis = 0; axis < 3; ++axis) {
    const float away = cell[axis] - crease.point[axis];
    if (std::abs(way[axis]) < 1e-6F) {
      if (std::abs(away) > kHalf) return false;
      continue;
    }
    const float s = (away - kHalf) / way[axis], t = (away + kHalf) / way[axis];
    from = std::max(from, std::min(s, t));
    to = std::min(to, std::max(s, t));
  }
  return from <= to;
}

class LoopSharpener {
 public:
  LoopSharpener(const grid::Volume& volume, const CubeCells& cells, const Mesh& mesh,
                double leastCosine, base::Job& job)
      : volume_(volume), cells_(cells), mesh_(mesh), leastCosine_(leastCosine), job_(job) {}

  SharpLoops run() {
    findSharp();
    // Outside of distance fields planes are not exact enough to follow them.
    if (volume_.scale.distance) addClipped();
    return std::move(found_);
  }

 private:
  // Finds the loops whose normals differ enough.
  void findSharp() {
    const std::size_t count = cells_.topology.blocks.size();
    found_.blocks.resize(count);
    planes_.resize(count);
    sharpCells_.resize(count);
    base::resizeLarge(found_.cells, cells_.topology.cellCount, job_);
    job_.forRanges(count, 32, [&](std::size_t begin, std::size_t end) {
      BlockTable tables(cells_);
      SheetsOfCell sheets(volume_);
      for (std::size_t i = begin; i < end; ++i) {
        sheets.moveTo(cells_.topology.blocks[i]);
        walkBlock(cells_, i, tables, [&](const WalkedCell& cell) { findSharp(cell, sheets); });
      }
    });
  }

  void findSharp(const WalkedCell& cell, SheetsOfCell& sheets) {
    const std::size_t i = cell.place.block;
    CellFeatures& features = found_.cells[cell.place.cell];
    features.first = static_cast<VertexIndex>(planes_[i].size());
    for (int loop = 0; loop < cell.cubeCase().loopCount; ++loop) {
      const LoopCrossings crossings = crossingsOf(cell, loop);
      if (crossings.areWithin(leastCosine_)) continue;
      const uniform::Qef planes = planesOf(cell, crossings);
      features.add(loop);
      planes_[i].push_back(planes);
      found_.blocks[i].push_back(featureFor(cell, crossings, placeAt(cell, planes, sheets)));
      sharpCells_[i].set(grid::cellIndex(cell.at[0], cell.at[1], cell.at[2]));
    }
  }

  [[nodiscard]] LoopCrossings crossingsOf(const WalkedCell& cell, int loop) const {
    return {cell.cubeCase(), loop, cell.tablePlace(), cell.table(), mesh_};
  }
  [[nodiscard]] uniform::Qef planesOf(const WalkedCell& cell,
                                      const LoopCrossings& crossings) const {
    return crossings.planes(volume_.affine, cell.corner(volume_.blocks));
  }
  [[nodiscard]] LoopFeature featureFor(const WalkedCell& cell, const LoopCrossings& crossings,
                                       const uniform::CreasePlacement& placed) const {
    return {featureAt(placed.point, cell.corner(volume_.blocks), crossings, volume_.affine),
            placed};
  }

  [[nodiscard]] uniform::CreasePlacement placeAt(const WalkedCell& cell, const uniform::Qef& planes,
                                                 SheetsOfCell& sheets) const {
    uniform::CreasePlacement placed;
    if (!volume_.scale.distance) {
      placed.point = uniform::solve(planes, CreasePoint::kHalfCell);
      return placed;
    }
    if (const auto found = sheets.at(cell.at, planes.massPoint())) return *found;
    // A crease may leave the cell and come back.
    const CreasePoint best(planes);
    placed.point = best.isInside ? best.inside : best.beyond;
    return placed;
  }

  // Adds the loops of cells that a crease clips.
  void addClipped() {
    SharpLoops all;
    all.blocks.resize(found_.blocks.size());
    base::resizeLarge(all.cells, found_.cells.size(), job_);
    job_.forRanges(all.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      BlockTable tables(cells_);
      SheetsOfCell sheets(volume_);
      for (std::size_t i = begin; i < end; ++i) {
        const grid::BlockBits near = cellsNearSharp(cells_.topology.blocks[i]);
        if (!near.any()) continue;
        sheets.moveTo(cells_.topology.blocks[i]);
        walkBlock(cells_, i, tables, [&](const WalkedCell& cell) {
          if (!near.get(grid::cellIndex(cell.at[0], cell.at[1], cell.at[2]))) return;
          addClipped(cell, sheets, all);
        });
      }
    });
    found_ = std::move(all);
  }

  // The cells of a block that have a sharp loop or a face in common with a cell that has.
  [[nodiscard]] grid::BlockBits cellsNearSharp(const SurfaceBlock& block) const {
    constexpr std::uint64_t kFirstZ = 0x0101010101010101u;
    const auto slab = [&](int dx, int dy, int dz, int x) {
      const auto index = cells_.topology.neighbour(block, dx, dy, dz);
      return index == uniform::kNoSurfaceBlock ? 0 : sharpCells_[index].slabs[x];
    };
    grid::BlockBits near;
    for (int x = 0; x < grid::kBlockSize; ++x) {
      const std::uint64_t here = slab(0, 0, 0, x);
      near.slabs[x] = here | here << 8 | here >> 8 | (here << 1 & ~kFirstZ) |
                      (here >> 1 & ~(kFirstZ << 7)) | slab(0, -1, 0, x) >> 56 |
                      slab(0, 1, 0, x) << 56 | (slab(0, 0, -1, x) >> 7 & kFirstZ) |
                      (slab(0, 0, 1, x) << 7 & kFirstZ << 7);
      near.slabs[x] |= x > 0 ? slab(0, 0, 0, x - 1) : slab(-1, 0, 0, grid::kBlockSize - 1);
      near.slabs[x] |= x + 1 < grid::kBlockSize ? slab(0, 0, 0, x + 1) : slab(1, 0, 0, 0);
    }
    return near;
  }

  void addClipped(const WalkedCell& cell, SheetsOfCell& sheets, SharpLoops& all) const {
    std::vector<LoopFeature>& own = all.blocks[cell.place.block];
    CellFeatures& features = all.cells[cell.place.cell];
    features.first = static_cast<VertexIndex>(own.size());
    for (int loop = 0; loop < cell.cubeCase().loopCount; ++loop) {
      if (const LoopFeature* const sharp = found_.of(cell.place, loop)) {
        features.add(loop);
        own.push_back(*sharp);
      } else if (isClipped(cell, loop)) {
        const LoopCrossings crossings = crossingsOf(cell, loop);
        const auto placed = creaseThrough(cell, loop, crossings, sheets);
        if (!placed) continue;
        features.add(loop);
        own.push_back(featureFor(cell, crossings, *placed));
      }
    }
  }

  // Calls body(place, index, middle) for the sharp loops beyond the arcs of a loop: the index among
  // those of the block, and where the middle of their cell is.
  template <class Body>
  void forSharpBeside(const WalkedCell& cell, int loop, const Body& body) const {
    forLoop(cell.cubeCase(), loop, [&](int edge) {
      const LoopBeyond beyond = loopBeyond(cells_, cell, edge);
      if (beyond.loop < 0 || !found_.cells[beyond.place.cell].has(beyond.loop)) return;
      uniform::Vector middle{};
      middle[beyond.face / 2] = (beyond.face & 1) != 0 ? 1.0F : -1.0F;
      body(beyond.place.block, found_.cells[beyond.place.cell].of(beyond.loop), middle);
    });
  }

  // A crease may clip a cell whose own crossings all lie on one sheet. The loops beyond its arcs
  // tell of it.
  [[nodiscard]] bool isClipped(const WalkedCell& cell, int loop) const {
    bool clipped = false;
    forSharpBeside(cell, loop, [&](std::size_t block, VertexIndex i, const uniform::Vector& at) {
      clipped = clipped || mayPass(found_.blocks[block][i].sheets, {-at[0], -at[1], -at[2]});
    });
    return clipped;
  }

  // Where the sheets of a loop and of those beyond its arcs meet in its cell.
  [[nodiscard]] std::optional<uniform::CreasePlacement> creaseThrough(
      const WalkedCell& cell, int loop, const LoopCrossings& crossings,
      SheetsOfCell& sheets) const {
    const uniform::Qef own = planesOf(cell, crossings);
    uniform::Qef planes = own;
    forSharpBeside(cell, loop, [&](std::size_t block, VertexIndex i, const uniform::Vector& at) {
      planes += planes_[block][i].seenFrom({-at[0], -at[1], -at[2]});
    });
    // Along the crease the vertex is nearest to the crossings of this loop.
    for (int i = 0; i < 3; ++i) planes.points[i] = own.points[i] * planes.count / own.count;
    if (!CreasePoint::mayBeInside(planes)) return std::nullopt;
    auto found = sheets.at(cell.at, own.massPoint());
    if (found && !found->outOfCell) return found;
    const CreasePoint best(planes);
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
  std::vector<std::vector<uniform::Qef>> planes_;  ///< of found_
  std::vector<grid::BlockBits> sharpCells_;        ///< of each surface block: with a sharp loop
};

}  // namespace

SharpLoops findSharpLoops(const grid::Volume& volume, const CubeCells& cells, const Mesh& mesh,
                          double leastCosine, base::Job& job) {
  return LoopSharpener(volume, cells, mesh, leastCosine, job).run();
}

}  // namespace tufa::extraction
