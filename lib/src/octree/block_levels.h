#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octree/cluster_forest.h"
#include "octree/patch.h"
#include "uniform/surface_view.h"

namespace tufa::octree {

/// Levels 1 to 3 of a range of consecutive blocks; indices count from 0 in each level of the range.
struct BlockLevels {
  std::array<ClusterLevel, ClusterForest::kBlockLevel> levels;
  std::vector<std::uint32_t> parents;  ///< of the blocks' uniform vertices
  std::vector<Patch> patches;          ///< of the clusters of level 3
};

/// Builds levels 1 to 3 block by block: what a block needs fits the cache, and patches, which are
/// large, are discarded with their block except for those of level 3. One builder serves many
/// blocks, so its arrays are allocated once.
class BlockLevelsBuilder {
 public:
  BlockLevelsBuilder(const uniform::SurfaceView& base, bool angles)
      : base_(base), angles_(angles) {}

  /// Appends the cells and clusters of surface block `index`.
  void append(std::size_t index, BlockLevels& out);

 private:
  // The patches of one level's cells in the block, cell by cell, by slotInBlock().
  struct Patches {
    std::vector<Patch> patches;
    std::array<std::uint32_t, grid::kBlockCells> first{};  // only of cells with patches
    std::array<std::uint32_t, grid::kBlockCells> count{};
    std::uint64_t occupied = 0;  // surface cells; not set for level 0
    std::uint64_t safe = 0;      // of these, the ones that may become leaves
  };

  void readVertices(std::size_t index);
  void addVertexPlanes(VertexIndex vertex, const Coord& origin, Patch& patch) const;
  void forbidBeside(std::size_t index);
  [[nodiscard]] bool neighbourOwnsBothArcs(std::size_t index, int cell, int face) const;
  void buildLevel(int level, ClusterLevel* below, ClusterLevel& out, std::size_t index);
  [[nodiscard]] bool isTried(int level, const Coord& cell) const;
  [[nodiscard]] bool join(int level, const Coord& cell, ClusterLevel* below, ClusterLevel& out);

  const uniform::SurfaceView base_;
  const bool angles_;
  PatchJoiner joiner_;
  std::array<Patches, ClusterForest::kBlockLevel + 1> levels_;
  std::vector<std::uint32_t> parents_;  ///< of the block's uniform vertices
  std::array<std::uint32_t, ClusterForest::kBlockLevel + 1> firstCluster_{};  ///< of the block
  std::uint64_t forbidden1_ = 0;  ///< cells of level 1 that must not become leaves
};

}  // namespace tufa::octree
