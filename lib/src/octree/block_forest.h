#pragma once

#include <vector>

#include "octree/cluster_forest.h"
#include "octree/patch.h"

namespace tufa::octree {

/// Builds levels 1 to 3 of one block. Made once for a range of blocks, so that its arrays are used
/// again.
class BlockForestBuilder {
 public:
  BlockForestBuilder(const uniform::SurfaceView& base, bool angles)
      : base_(base), angles_(angles) {}

  /// Builds the forest of surface block `index`, and appends its parents and clusters to those of
  /// the group. The parents in its level 2 count from 0.
  [[nodiscard]] BlockForest build(std::size_t index, BlockGroup& group);

  /// Of the block built last, the patches and clusters of level 3; none unless isSafe().
  [[nodiscard]] bool isSafe() const { return safe3_; }
  [[nodiscard]] std::vector<Patch>& patches() { return levels_[3].patches; }
  [[nodiscard]] std::vector<Cluster>& clusters() { return clusters3_; }

 private:
  // The patches of one level's cells in the block, cell by cell.
  struct Patches {
    std::vector<Patch> patches;
    std::array<std::uint32_t, grid::kBlockCells> first{};  // only of cells with patches
    std::array<std::uint32_t, grid::kBlockCells> count{};
  };

  void readVertices(std::size_t index);
  void addVertexPlanes(VertexIndex vertex, const Coord& origin, Patch& patch) const;
  void forbidBeside(std::size_t index);
  [[nodiscard]] bool neighbourOwnsBothArcs(std::size_t index, int cell, int face) const;
  // Tries one cell of level `level`, at (x, y, z) in cells of that level; appends what it finds.
  [[nodiscard]] bool tryCell(int level, int x, int y, int z, std::vector<Cluster>& clusters);
  [[nodiscard]] static int slot(int level, int x, int y, int z) {
    const int bits = 3 - level;
    return ((x << bits | y) << bits) | z;
  }
  void setParent(int level, std::uint32_t patch, std::uint32_t parent);

  const uniform::SurfaceView base_;
  const bool angles_;
  BlockForest forest_;
  PatchJoiner joiner_;
  std::array<Patches, 4> levels_;  ///< levels 0 to 3
  std::vector<std::uint16_t> parents_;
  std::vector<Cluster> clusters1_, clusters2_, clusters3_;
  std::uint64_t forbidden1_ = 0;
  bool safe3_ = false;
};

}  // namespace tufa::octree
