#include "octree/build_forest.h"

#include <algorithm>
#include <utility>

#include "base/huge_pages.h"
#include "base/shrink.h"
#include "octree/block_levels.h"
#include "octree/upper_levels.h"

namespace tufa::octree {
namespace {

// Blocks in a range. Each range has one builder and arrays of its own: enough blocks that few
// arrays are allocated, few enough that threads are kept busy.
constexpr std::size_t kBlocksInRange = 64;

// Copies `from` into `to` from index `begin` on, each element as map() gives it.
template <class T, class Map>
void copyTo(const std::vector<T>& from, std::size_t begin, std::vector<T>& to, const Map& map) {
  std::transform(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(begin), map);
}

// Concatenates the levels of all ranges. Prefix sums tell where each range goes, so ranges are
// copied in parallel and the order is that of the blocks for any number of threads. Indices inside
// a range become indices in the forest. A range is freed as soon as it is copied, so that little is
// held twice.
class RangeJoiner {
 public:
  RangeJoiner(std::vector<BlockLevels>& ranges, ClusterForest& forest, std::vector<Patch>& patches,
              base::Job& job)
      : ranges_(ranges), forest_(forest), patches_(patches), job_(job), begins_(ranges.size() + 1) {
    for (std::size_t r = 0; r < ranges.size(); ++r) {
      Begin& next = begins_[r + 1];
      next = begins_[r];
      for (int l = 0; l < ClusterForest::kBlockLevel; ++l) {
        next.cells[l] += ranges[r].levels[l].cells.size();
        next.clusters[l] += ranges[r].levels[l].clusters.size();
      }
      next.vertices += ranges[r].parents.size();
    }
  }

  void join(std::size_t blockCount) {
    const Begin& total = begins_.back();
    forest_.levels.resize(ClusterForest::kBlockLevel);
    for (int l = 0; l < ClusterForest::kBlockLevel; ++l) {
      ClusterLevel& level = forest_.levels[l];
      level.level = l + 1;
      base::resizeLarge(level.cells, total.cells[l], job_);
      base::resizeLarge(level.safe, total.cells[l], job_);
      base::resizeLarge(level.first, total.cells[l] + 1, job_);
      base::resizeLarge(level.clusters, total.clusters[l], job_);
      level.first.back() = static_cast<std::uint32_t>(total.clusters[l]);
      if (l + 1 == ClusterForest::kBlockLevel) break;
      base::resizeLarge(level.parentCells, total.cells[l], job_);
      level.occupied.resize(blockCount);
      level.firstInBlock.resize(blockCount);
    }
    base::resizeLarge(forest_.parents, total.vertices, job_);
    base::resizeLarge(patches_, total.clusters[ClusterForest::kBlockLevel - 1], job_);
    job_.forRanges(ranges_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r) {
        for (int l = 0; l < ClusterForest::kBlockLevel; ++l) joinLevel(r, l);
        joinRest(r);
        ranges_[r] = {};
      }
    });
    ClusterLevel& top = forest_.levels.back();
    top.table.reserve(top.cells.size());
    for (std::uint32_t i = 0; i < top.cells.size(); ++i) {
      job_.pollCancelled(i);
      top.table.tryEmplace(top.cells[i], i);
    }
  }

 private:
  // How many elements precede those of a range.
  struct Begin {
    std::array<std::size_t, ClusterForest::kBlockLevel> cells{}, clusters{};
    std::size_t vertices = 0;
  };

  void joinLevel(std::size_t range, int l) {
    const Begin& begin = begins_[range];
    const ClusterLevel& from = ranges_[range].levels[l];
    ClusterLevel& to = forest_.levels[l];
    const auto cells = static_cast<std::uint32_t>(begin.cells[l]);
    const auto clusters = static_cast<std::uint32_t>(begin.clusters[l]);
    const bool last = l + 1 == ClusterForest::kBlockLevel;
    const auto cellsAbove = last ? 0 : static_cast<std::uint32_t>(begin.cells[l + 1]);
    const auto clustersAbove = last ? 0 : static_cast<std::uint32_t>(begin.clusters[l + 1]);
    copyTo(from.cells, cells, to.cells, [](const Coord& cell) { return cell; });
    copyTo(from.safe, cells, to.safe, [](std::uint8_t safe) { return safe; });
    copyTo(from.first, cells, to.first, [&](std::uint32_t first) { return first + clusters; });
    copyTo(from.clusters, clusters, to.clusters, [&](Cluster cluster) {
      cluster.cell += cells;
      if (cluster.parent != kNone) cluster.parent += clustersAbove;
      return cluster;
    });
    if (last) return;
    const std::size_t blocks = range * kBlocksInRange;
    copyTo(from.parentCells, cells, to.parentCells,
           [&](std::uint32_t cell) { return cell + cellsAbove; });
    copyTo(from.occupied, blocks, to.occupied, [](std::uint64_t bits) { return bits; });
    copyTo(from.firstInBlock, blocks, to.firstInBlock,
           [&](std::uint32_t first) { return first + cells; });
  }

  void joinRest(std::size_t range) {
    const auto clusters = static_cast<std::uint32_t>(begins_[range].clusters[0]);
    copyTo(ranges_[range].parents, begins_[range].vertices, forest_.parents,
           [&](std::uint32_t parent) { return parent == kNone ? kNone : parent + clusters; });
    copyTo(ranges_[range].patches, begins_[range].clusters[ClusterForest::kBlockLevel - 1],
           patches_, [](const Patch& patch) { return patch; });
  }

  std::vector<BlockLevels>& ranges_;
  ClusterForest& forest_;
  std::vector<Patch>& patches_;
  base::Job& job_;
  std::vector<Begin> begins_;  ///< of each range, and the totals
};

// Builds levels 1 to 3 and returns the patches of the clusters of level 3, which the level above is
// built from.
std::vector<Patch> buildBlockLevels(const uniform::SurfaceView& base, bool angles,
                                    ClusterForest& forest, base::Job& job) {
  const std::size_t count = base.topology.blocks.size();
  std::vector<BlockLevels> ranges((count + kBlocksInRange - 1) / kBlocksInRange);
  job.forRanges(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
    BlockLevelsBuilder builder(base, angles);
    for (std::size_t i = begin * kBlocksInRange; i < std::min(end * kBlocksInRange, count); ++i) {
      builder.append(i, ranges[i / kBlocksInRange]);
    }
  });
  std::vector<Patch> patches;
  RangeJoiner(ranges, forest, patches, job).join(count);
  return patches;
}

}  // namespace

ClusterForest buildForest(const uniform::SurfaceView& base, int maxLevel, bool angles,
                          base::Job& job) {
  ClusterForest forest;
  std::vector<Patch> patches = buildBlockLevels(base, angles, forest, job);
  while (forest.topLevel() < maxLevel && !forest.levels.back().clusters.empty()) {
    ClusterLevel above = buildLevelAbove(forest.levels.back(), patches, base.affine, job);
    // No two cells have a common parent, so that no component passes three cells in a row: a cell
    // that joins some of them holds a whole component, which is no disk. Across a coordinate plane
    // none ever joins any.
    if (above.cells.size() == forest.levels.back().cells.size()) break;
    forest.levels.push_back(std::move(above));
  }
  base::release(forest.levels.back().parentCells);
  return forest;
}

}  // namespace tufa::octree
