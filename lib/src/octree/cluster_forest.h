#pragma once

#include <tufa/mesh.h>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/coord_table.h"
#include "base/job.h"
#include "grid/affine.h"
#include "grid/blocks.h"
#include "uniform/cell_topology.h"
#include "uniform/surface_view.h"

namespace tufa::octree {

inline constexpr std::uint32_t kNone = base::CoordTable::kNone;

/// A connected piece of the surface in one octree cell, which one vertex can stand for.
struct Cluster {
  std::array<float, 3> point;   ///< the vertex, in voxels from the middle of the cell
  std::array<float, 3> normal;  ///< outward unit normal, world space
  float error = 0;  ///< root mean square distance of the vertex to the gathered planes, voxels
  float angle = 0;  ///< bound on the angle between two gathered normals, radians
  std::uint32_t parent = kNone;  ///< the cluster one level up that holds this one
  std::uint16_t cell = 0;        ///< levels 1 and 2: the cell inside the block
};

/// Number of a level-1 cell (x, y, z each 0..3) or level-2 cell (0..1) inside its block.
inline constexpr int cellIndex1(int x, int y, int z) { return x * 16 + y * 4 + z; }
inline constexpr int cellIndex2(int x, int y, int z) { return x * 4 + y * 2 + z; }

/// The cells of levels 1 and 2 of one block, and how many clusters they have.
struct BlockForest {
  std::uint64_t surface1 = 0;  ///< level-1 cells that the surface passes
  std::uint64_t safe1 = 0;     ///< of these, the ones that may become leaves
  std::uint8_t surface2 = 0;
  std::uint8_t safe2 = 0;
  std::uint16_t vertices = 0, clusters1 = 0, clusters2 = 0;
  std::uint32_t firstVertex = 0, firstCluster = 0;  ///< in their BlockGroup
};

/// What is of different size in each of some consecutive blocks: few arrays are freed in no time.
struct BlockGroup {
  static constexpr std::size_t kBlocks = 64;
  static constexpr std::uint16_t kNoParent = std::numeric_limits<std::uint16_t>::max();

  std::vector<std::uint16_t> parents;  ///< of each base vertex: its level-1 cluster or kNoParent
  std::vector<Cluster> clusters;       ///< block by block, of level 1, then of level 2
};

/// One level of cells of the size of a block or larger: all that the surface passes.
struct Level {
  int level = 3;
  std::vector<Coord> cells;        ///< lower corner, in cells of this level
  std::vector<std::uint8_t> safe;  ///< may become a leaf
  std::vector<std::uint32_t>
      first;  ///< clusters of cell i: first[i] to first[i + 1]; none unless safe
  std::vector<Cluster> clusters;
  std::vector<std::uint32_t> parentCells;  ///< in the next level; empty at the last

  /// Index of a cell, or kNone where the surface does not pass.
  [[nodiscard]] std::uint32_t find(const Coord& cell) const { return indices.find(cell); }
  base::CoordTable indices;
};

/// The surface as clusters of all sizes, each with the vertex that would stand for it: what every
/// cut is taken from. Depends on no tolerance. A cell is there if all its patches, at every level
/// below, pass the safety test; see PatchJoiner.
struct Forest {
  std::vector<BlockForest> blocks;  ///< for each surface block of the topology
  std::vector<BlockGroup> groups;   ///< of the blocks, so many each
  std::vector<Level> levels;        ///< level 3 (cell i is surface block i), 4, and so on

  /// Of each base vertex of a block: its level-1 cluster or BlockGroup::kNoParent.
  [[nodiscard]] std::span<const std::uint16_t> parents(std::size_t block) const {
    const BlockForest& own = blocks[block];
    return {groups[block / BlockGroup::kBlocks].parents.data() + own.firstVertex, own.vertices};
  }
  /// The clusters of a block's level-1 cells; their parents are in level2().
  [[nodiscard]] std::span<const Cluster> level1(std::size_t block) const {
    const BlockForest& own = blocks[block];
    return {groups[block / BlockGroup::kBlocks].clusters.data() + own.firstCluster, own.clusters1};
  }
  /// The clusters of a block's level-2 cells; their parents are in levels[0].
  [[nodiscard]] std::span<const Cluster> level2(std::size_t block) const {
    const BlockForest& own = blocks[block];
    return {groups[block / BlockGroup::kBlocks].clusters.data() + own.firstCluster + own.clusters1,
            own.clusters2};
  }
};

/// Builds the levels from the base mesh up, until none has a safe cell or cells have 2^maxLevel
/// voxels. `angles`: gather the angles between normals, too; else they are 0.
[[nodiscard]] Forest buildForest(const uniform::SurfaceView& base, int maxLevel, bool angles,
                                 base::Job& job);

}  // namespace tufa::octree
