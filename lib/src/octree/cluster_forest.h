#pragma once

#include <tufa/coord.h>

#include <array>
#include <cstdint>
#include <vector>

#include "base/bits.h"
#include "base/coord_table.h"

namespace tufa::octree {

inline constexpr std::uint32_t kNone = base::CoordTable::kNone;

/// A connected part of the surface in one octree cell, and the vertex that can stand for it.
struct Cluster {
  std::array<float, 3> point;   ///< the vertex, in voxels from the middle of the cell
  std::array<float, 3> normal;  ///< outward unit normal, world space
  float error = 0;  ///< root mean square distance of the vertex to the gathered planes, voxels
  float angle = 0;  ///< bound on the angle between two gathered normals, radians
  std::uint32_t cell = kNone;    ///< of its level
  std::uint32_t parent = kNone;  ///< the cluster one level up that holds this one
};

/// All surface cells of one size and their clusters. The cells of a block (levels below 3) are
/// consecutive, in the order of the blocks; those of higher levels are in the order of their first
/// child.
struct ClusterLevel {
  int level = 0;                   ///< cells have 2^level voxels along their edge
  std::vector<Coord> cells;        ///< lower corner, in cells of this level
  std::vector<std::uint8_t> safe;  ///< may become a leaf
  std::vector<std::uint32_t>
      first;  ///< clusters of cell i: first[i] to first[i + 1]; none unless safe
  std::vector<Cluster> clusters;           ///< cell by cell
  std::vector<std::uint32_t> parentCells;  ///< in the next level; empty at the last

  /// Levels below 3: for each block a bit for each of its cells, by slotInBlock(), and the index of
  /// its first cell. The rank of a bit plus that index is the index of the cell.
  std::vector<std::uint64_t> occupied;
  std::vector<std::uint32_t> firstInBlock;
  /// Level 3 and above: from coordinates to cells.
  base::CoordTable table;

  [[nodiscard]] Coord corner(std::uint32_t cell) const { return cells[cell] << level; }
};

/// The surface as clusters of all sizes, from which every cut is taken. It depends on no tolerance.
/// A cell has clusters if its patches, and those of all cells below it, pass the safety test (see
/// PatchJoiner). All levels have one form: an array of cells and an array of their clusters. Cost:
/// 40 bytes per cluster; no field value is read again.
struct ClusterForest {
  /// Level 3: its cells are the surface blocks, cell i is surface block i.
  static constexpr int kBlockLevel = 3;

  std::vector<std::uint32_t> parents;  ///< of each uniform vertex: its level-1 cluster or kNone
  std::vector<ClusterLevel> levels;    ///< levels 1, 2, 3 and so on

  [[nodiscard]] int topLevel() const { return static_cast<int>(levels.size()); }
  [[nodiscard]] const ClusterLevel& at(int level) const { return levels[level - 1]; }

  /// The number of a cell inside its block, `local` counted from the block's first cell of that
  /// level.
  [[nodiscard]] static int slotInBlock(int level, const Coord& local) {
    const int bits = kBlockLevel - level;
    return (((local[0] << bits) | local[1]) << bits) | local[2];
  }
  /// The index of a cell of a level below 3 in a block, by its slot; kNone if it is no surface
  /// cell.
  [[nodiscard]] std::uint32_t findInBlock(int level, std::uint32_t block, int slot) const {
    const ClusterLevel& own = at(level);
    const std::uint64_t occupied = own.occupied[block];
    if (((occupied >> slot) & 1) == 0) return kNone;
    return own.firstInBlock[block] +
           static_cast<std::uint32_t>(base::countBits(occupied & base::bitsBelow(slot)));
  }
  /// The index of a cell of a level by its coordinates, in cells of that level; kNone if it is no
  /// surface cell.
  [[nodiscard]] std::uint32_t find(int level, const Coord& cell) const {
    if (level >= kBlockLevel) return at(level).table.find(cell);
    const int bits = kBlockLevel - level;
    const std::uint32_t block = at(kBlockLevel).table.find(cell >> bits);
    if (block == kNone) return kNone;
    return findInBlock(level, block, slotInBlock(level, cell & ((1 << bits) - 1)));
  }
};

}  // namespace tufa::octree
