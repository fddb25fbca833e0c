#include "extract/cube_cells.h"

#include "base/huge_pages.h"
#include "grid/samples.h"

namespace tufa::extraction {

using grid::BlockSamples;
using grid::kBlockSize;
using uniform::SurfaceBlock;

namespace {

// Shares of the time that stages took on the sample volumes.
constexpr double kCellsEnd = 0.25, kCasesEnd = 0.4;

CornerValues valuesAt(const BlockSamples& samples, int cell) {
  CornerValues values;
  const int lowest = BlockSamples::index(cell >> 6, (cell >> 3) & 7, cell & 7);
  for (int corner = 0; corner < kCorners; ++corner) {
    values[corner] = samples[lowest + (corner >> 2) * BlockSamples::kStrideX +
                             ((corner >> 1) & 1) * BlockSamples::kStrideY + (corner & 1)];
  }
  return values;
}

class Chooser {
 public:
  Chooser(const grid::Volume& volume, const CubeRule& rule, CubeCells& cells, base::Job& job)
      : volume_(volume), rule_(rule), cells_(cells), topology_(cells.topology), job_(job) {}

  void run() {
    const std::size_t count = topology_.blocks.size();
    base::resizeLarge(cells_.edges, count, job_);
    base::resizeLarge(cells_.codes, topology_.cellCount, job_);
    cells_.counts.resize(count);
    job_.forRanges(count, 32, [&](std::size_t begin, std::size_t end) {
      const auto accessor = volume_.blocks.accessor();
      for (std::size_t i = begin; i < end; ++i) {
        const grid::CornerWords corners =
            volume_.blocks.cornerWords(topology_.blocks[i].neighbours);
        findEdges(topology_.blocks[i], corners, cells_.edges[i]);
        choose(topology_.blocks[i], corners, cells_.counts[i], *accessor);
      }
    });
  }

 private:
  void findEdges(const SurfaceBlock& block, const grid::CornerWords& corners,
                 CubeEdges& edges) const {
    for (int x = 0; x < kBlockSize; ++x) {
      const auto crossed = uniform::crossedEdges(corners, x);
      for (int axis = 0; axis < 3; ++axis) {
        const std::uint64_t open =
            block.special < 0 ? 0 : topology_.specials[block.special].cut[axis].slabs[x];
        edges.crossed[axis].slabs[x] = crossed[axis] & ~open;
      }
    }
    edges.countEdges();
  }

  void choose(const SurfaceBlock& block, const grid::CornerWords& corners,
              CubeCells::Counts& counts, grid::Accessor& accessor) {
    CaseCode* code = cells_.codes.data() + block.firstVertex;
    const bool mayBeOpen = topology_.openEdges > 0;
    BlockSamples samples;
    bool gathered = false;
    for (int x = 0; x < kBlockSize; ++x) {
      base::forEachBit(block.cells.slabs[x], [&](int bit) {
        const int cell = x * 64 + bit;
        const CornerMask mask = uniform::cornerMask(corners, cell);
        *code = rule_.codes[mask];
        if (mayBeOpen && topology_.openEdgesOf(block, cell) != 0) {
          *code = 0;
        } else if (rule_.asks[mask]) {
          if (!gathered) {
            samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, accessor);
          }
          gathered = true;
          *code = rule_.decide(mask, valuesAt(samples, cell));
        }
        const CubeCase& chosen = caseOf(*code++);
        counts.triangles += chosen.count;
        counts.centres += chosen.centreCount;
      });
    }
  }

  const grid::Volume& volume_;
  const CubeRule& rule_;
  CubeCells& cells_;
  const uniform::CellTopology& topology_;
  base::Job& job_;
};

}  // namespace

CubeCells chooseCases(const grid::Volume& volume, const CubeRule& rule, bool cap, base::Job& job) {
  CubeCells cells;
  job.beginStage("cells", kCellsEnd);
  cells.topology = uniform::findSurfaceCells(volume.blocks, volume.scale, cap, job);
  job.beginStage("cases", kCasesEnd);
  Chooser(volume, rule, cells, job).run();
  cells.edgeCount = numberEdges(cells.edges, job);
  return cells;
}

}  // namespace tufa::extraction
