#include "forest/forest.h"

#include <algorithm>

#include "base/huge_pages.h"
#include "forest/block_forest.h"
#include "forest/upper_levels.h"

namespace tufa::forest {
namespace {

// What a range of blocks leaves for level 3.
struct BlockTop {
  std::vector<Cluster> clusters;
  std::vector<Patch> patches;
};

// Level 3: its cells are the surface blocks.
template <class TreeT>
LevelPatches buildBlocks(const Base<TreeT>& base, std::vector<BlockForest>& blocks,
                         base::Job& job) {
  const std::size_t count = base.topology.blocks.size();
  LevelPatches top;
  top.level.safe.resize(count);
  top.level.cells.resize(count);
  std::vector<BlockTop> tops;
  base::resizeLarge(tops, count, job);
  base::resizeLarge(blocks, count, job);
  job.forRanges(count, 32, [&](std::size_t begin, std::size_t end) {
    BlockForestBuilder<TreeT> builder(base);
    for (std::size_t i = begin; i < end; ++i) {
      blocks[i] = builder.build(i);
      const openvdb::Coord& origin = base.origin(i);
      top.level.cells[i] = openvdb::Coord(origin[0] >> 3, origin[1] >> 3, origin[2] >> 3);
      top.level.safe[i] = builder.isSafe() ? 1 : 0;
      if (builder.isSafe()) tops[i] = {builder.clusters(), builder.patches()};
    }
  });
  top.level.first.reserve(count + 1);
  std::size_t clusters = 0;
  for (const BlockTop& own : tops) clusters += own.clusters.size();
  base::reserveLarge(top.level.clusters, clusters);
  base::reserveLarge(top.patches, clusters);
  job.look(0, 1);
  top.level.indices.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    job.lookAtTimes(i);
    const auto first = static_cast<std::uint32_t>(top.level.clusters.size());
    top.level.first.push_back(first);
    top.level.indices.emplace(top.level.cells[i], i);
    if (top.level.safe[i] == 0) continue;
    for (Cluster& cluster : blocks[i].level2) cluster.parent += first;
    top.level.clusters.insert(top.level.clusters.end(), tops[i].clusters.begin(),
                              tops[i].clusters.end());
    top.patches.insert(top.patches.end(), tops[i].patches.begin(), tops[i].patches.end());
    tops[i] = {};
  }
  top.level.first.push_back(static_cast<std::uint32_t>(top.level.clusters.size()));
  return top;
}

}  // namespace

template <class TreeT>
Forest buildForest(const Base<TreeT>& base, int maxLevel, base::Job& job) {
  Forest forest;
  LevelPatches top = buildBlocks(base, forest.blocks, job);
  while (top.level.level < maxLevel && !top.level.clusters.empty()) {
    LevelPatches above = buildLevelAbove(top, base.affine, job);
    // Cells that never share a parent, such as those around the origin: larger ones change nothing.
    if (above.level.cells.size() == top.level.cells.size()) break;
    forest.levels.push_back(std::move(top.level));
    top = std::move(above);
  }
  top.level.parentCells = {};
  forest.levels.push_back(std::move(top.level));
  return forest;
}

template Forest buildForest(const Base<openvdb::FloatTree>&, int, base::Job&);
template Forest buildForest(const Base<openvdb::DoubleTree>&, int, base::Job&);

}  // namespace tufa::forest
