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
// Ranges that are built before they are joined: enough for threads, few enough that little is held
// twice.
constexpr std::size_t kRangesAtOnce = 64;

// Copies `from` into `to` from index `begin` on, each element as map() gives it.
template <class T, class Map>
void copyTo(const std::vector<T>& from, std::size_t begin, std::vector<T>& to, const Map& map) {
  std::transform(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(begin), map);
}

// Appends the levels of ranges, some at a time, to those of the forest. Prefix sums tell where each
// range goes, so ranges are copied in parallel and the order is that of the blocks for any number
// of threads. Indices inside a range become indices in the forest.
class RangeJoiner {
 public:
  RangeJoiner(std::size_t blockCount, ClusterForest& forest, std::vector<Patch>& patches,
              base::Job& job)
      : blockCount_(blockCount), forest_(forest), patches_(patches), job_(job) {
    forest.levels.resize(ClusterForest::kBlockLevel);
    for (int l = 0; l < ClusterForest::kBlockLevel; ++l) forest.levels[l].level = l + 1;
  }

  // `blocks`: how many there are in the ranges. Leaves the ranges as they are.
  void append(const std::vector<BlockLevels>& ranges, std::size_t blocks) {
    const std::size_t firstBlock = blocks_;
    blocks_ += blocks;
    std::vector<Begin> begins(1, end_);
    for (const BlockLevels& range : ranges) {
      for (int l = 0; l < ClusterForest::kBlockLevel; ++l) {
        end_.cells[l] += range.levels[l].cells.size();
        end_.clusters[l] += range.levels[l].clusters.size();
      }
      end_.vertices += range.parents.size();
      begins.push_back(end_);
    }
    grow();
    job_.forRanges(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r) {
        for (int l = 0; l < ClusterForest::kBlockLevel; ++l) {
          joinLevel(ranges[r].levels[l], l, begins[r], firstBlock + r * kBlocksInRange);
        }
        joinRest(ranges[r], begins[r]);
      }
    });
  }

  // To be called behind the last range.
  void finish() {
    for (int l = 0; l < ClusterForest::kBlockLevel; ++l) {
      forest_.levels[l].first.push_back(static_cast<std::uint32_t>(end_.clusters[l]));
    }
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

  // Makes room for what comes next. Where there is none, room is made for all blocks, as many
  // elements each as those so far: none of it is memory before it is written.
  void grow() {
    const auto resize = [&](auto& vector, std::size_t count) {
      if (vector.capacity() < count) {
        constexpr double kSpare = 1.05;
        const double all = kSpare * static_cast<double>(count) * static_cast<double>(blockCount_) /
                           static_cast<double>(blocks_);
        base::growLarge(vector, static_cast<std::size_t>(all) + 1);
      }
      vector.resize(count);
    };
    for (int l = 0; l < ClusterForest::kBlockLevel; ++l) {
      ClusterLevel& level = forest_.levels[l];
      resize(level.cells, end_.cells[l]);
      resize(level.safe, end_.cells[l]);
      resize(level.first, end_.cells[l]);
      resize(level.clusters, end_.clusters[l]);
      if (l + 1 == ClusterForest::kBlockLevel) break;
      resize(level.parentCells, end_.cells[l]);
      resize(level.occupied, blocks_);
      resize(level.firstInBlock, blocks_);
    }
    resize(forest_.parents, end_.vertices);
    resize(patches_, end_.clusters[ClusterForest::kBlockLevel - 1]);
  }

  void joinLevel(const ClusterLevel& from, int l, const Begin& begin, std::size_t block) {
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
    copyTo(from.parentCells, cells, to.parentCells,
           [&](std::uint32_t cell) { return cell + cellsAbove; });
    copyTo(from.occupied, block, to.occupied, [](std::uint64_t bits) { return bits; });
    copyTo(from.firstInBlock, block, to.firstInBlock,
           [&](std::uint32_t first) { return first + cells; });
  }

  void joinRest(const BlockLevels& range, const Begin& begin) {
    const auto clusters = static_cast<std::uint32_t>(begin.clusters[0]);
    copyTo(range.parents, begin.vertices, forest_.parents,
           [&](std::uint32_t parent) { return parent == kNone ? kNone : parent + clusters; });
    copyTo(range.patches, begin.clusters[ClusterForest::kBlockLevel - 1], patches_,
           [](const Patch& patch) { return patch; });
  }

  std::size_t blockCount_;
  ClusterForest& forest_;
  std::vector<Patch>& patches_;
  base::Job& job_;
  std::size_t blocks_ = 0;  ///< appended
  Begin end_;               ///< of them
};

// Builds levels 1 to 3 and returns the patches of the clusters of level 3, which the level above is
// built from.
std::vector<Patch> buildBlockLevels(const uniform::SurfaceView& base, bool angles,
                                    ClusterForest& forest, base::Job& job) {
  const std::size_t count = base.topology.blocks.size();
  std::vector<Patch> patches;
  RangeJoiner joiner(count, forest, patches, job);
  const auto shareOf = [&](std::size_t blocks) {
    return static_cast<double>(blocks) / static_cast<double>(count);
  };
  for (std::size_t first = 0; first < count; first += kRangesAtOnce * kBlocksInRange) {
    const std::size_t blocks = std::min(kRangesAtOnce * kBlocksInRange, count - first);
    job.beginLoop(shareOf(first), shareOf(first + blocks));
    std::vector<BlockLevels> ranges((blocks + kBlocksInRange - 1) / kBlocksInRange);
    job.forRanges(ranges.size(), 1, [&](std::size_t begin, std::size_t end) {
      BlockLevelsBuilder builder(base, angles);
      for (std::size_t i = begin * kBlocksInRange; i < std::min(end * kBlocksInRange, blocks);
           ++i) {
        builder.append(first + i, ranges[i / kBlocksInRange]);
      }
    });
    joiner.append(ranges, blocks);
  }
  joiner.finish();
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
