#include "octree/cluster_forest.h"

#include <algorithm>
#include <array>

#include "base/huge_pages.h"
#include "octree/block_forest.h"
#include "octree/upper_levels.h"

namespace tufa::octree {
namespace {

// What a group of blocks leaves for level 3.
struct GroupTop {
  std::array<std::uint16_t, BlockGroup::kBlocks> counts{};  // of each block, if it is safe
  std::vector<Cluster> clusters;
  std::vector<Patch> patches;
};

// Level 3: its cells are the surface blocks.
LevelPatches buildBlocks(const uniform::SurfaceView& base, bool angles, Forest& forest,
                         base::Job& job) {
  constexpr std::size_t kBlocks = BlockGroup::kBlocks;
  const std::size_t count = base.topology.blocks.size();
  LevelPatches top;
  top.level.safe.resize(count);
  top.level.cells.resize(count);
  std::vector<GroupTop> tops((count + kBlocks - 1) / kBlocks);
  forest.groups.resize(tops.size());
  base::resizeLarge(forest.blocks, count, job);
  job.forRanges(tops.size(), 1, [&](std::size_t begin, std::size_t end) {
    BlockForestBuilder builder(base, angles);
    for (std::size_t i = begin * kBlocks; i < std::min(end * kBlocks, count); ++i) {
      forest.blocks[i] = builder.build(i, forest.groups[i / kBlocks]);
      const Coord& origin = base.origin(i);
      top.level.cells[i] = Coord(origin[0] >> 3, origin[1] >> 3, origin[2] >> 3);
      top.level.safe[i] = builder.isSafe() ? 1 : 0;
      if (!builder.isSafe()) continue;
      GroupTop& own = tops[i / kBlocks];
      own.counts[i % kBlocks] = static_cast<std::uint16_t>(builder.clusters().size());
      own.clusters.insert(own.clusters.end(), builder.clusters().begin(), builder.clusters().end());
      own.patches.insert(own.patches.end(), builder.patches().begin(), builder.patches().end());
    }
  });
  top.level.first.reserve(count + 1);
  std::size_t clusters = 0;
  for (const GroupTop& own : tops) clusters += own.clusters.size();
  base::reserveLarge(top.level.clusters, clusters);
  base::reserveLarge(top.patches, clusters);
  job.look(0, 1);
  top.level.indices.reserve(count);
  for (std::size_t group = 0; group < tops.size(); ++group) {
    GroupTop& own = tops[group];
    auto first = static_cast<std::uint32_t>(top.level.clusters.size());
    for (std::size_t i = group * kBlocks; i < std::min((group + 1) * kBlocks, count); ++i) {
      job.lookAtTimes(i);
      top.level.first.push_back(first);
      top.level.indices.tryEmplace(top.level.cells[i], static_cast<std::uint32_t>(i));
      if (top.level.safe[i] == 0) continue;
      const BlockForest& block = forest.blocks[i];
      Cluster* level2 = &forest.groups[group].clusters[block.firstCluster + block.clusters1];
      for (int c = 0; c < block.clusters2; ++c) level2[c].parent += first;
      first += own.counts[i % kBlocks];
    }
    top.level.clusters.insert(top.level.clusters.end(), own.clusters.begin(), own.clusters.end());
    top.patches.insert(top.patches.end(), own.patches.begin(), own.patches.end());
    own = {};
  }
  top.level.first.push_back(static_cast<std::uint32_t>(top.level.clusters.size()));
  return top;
}

}  // namespace

Forest buildForest(const uniform::SurfaceView& base, int maxLevel, bool angles, base::Job& job) {
  Forest forest;
  LevelPatches top = buildBlocks(base, angles, forest, job);
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

}  // namespace tufa::octree
