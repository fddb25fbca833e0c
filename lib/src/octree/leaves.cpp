#include "octree/leaves.h"

#include <algorithm>
#include <array>

#include "base/bits.h"

namespace tufa::octree {

using uniform::SurfaceBlock;
using uniform::SurfaceBlockIndex;
using uniform::Topology;

namespace {

// Share of the tolerance that a cluster's mean error may take. On a curved patch the largest
// distance is about twice the mean one; what slips through is found and split by the certificate.
constexpr double kErrorShare = 0.5;

class Merger {
 public:
  Merger(const Forest& forest, const Topology& topology, const CutRule& rule,
         const CellFlags& forbidden, base::Job& job)
      : forest_(forest),
        topology_(topology),
        rule_(rule),
        forbidden_(forbidden),
        job_(job),
        merged_(forest) {}

  CellFlags merge() {
    mergeLevel1();
    mergeLevel2();
    mergeBlocks();
    for (std::size_t i = 1; i < forest_.levels.size(); ++i) mergeUpper(i);
    return std::move(merged_);
  }

 private:
  // `middle` is the middle of the cell, in lattice coordinates.
  [[nodiscard]] bool keepsRule(const Cluster& cluster, int level, const Vec3& middle) const {
    if (level > rule_.maxLevel) return false;
    if (level <= rule_.minLevel) return true;
    const Vec3 point(cluster.point[0], cluster.point[1], cluster.point[2]);
    return cluster.error <= kErrorShare * rule_.toleranceAt(middle + point) &&
           cluster.angle <= rule_.maxAngle;
  }

  [[nodiscard]] Vec3 middleOf(std::size_t block, int level, int x, int y, int z) const {
    const Coord& cell = forest_.levels[0].cells[block];
    const double size = 1 << level;
    return Vec3(cell[0] * 8.0, cell[1] * 8.0, cell[2] * 8.0) +
           Vec3(x + 0.5, y + 0.5, z + 0.5) * size;
  }

  // Whether two cells of a level are in chunks of their own, between which there is no balance.
  [[nodiscard]] bool areApart(const Coord& a, const Coord& b, int level) const {
    if (rule_.chunkLevel >= CutRule::kNoChunks) return false;
    const int shift = rule_.chunkLevel - level;
    return (a[0] >> shift) != (b[0] >> shift) || (a[1] >> shift) != (b[1] >> shift) ||
           (a[2] >> shift) != (b[2] >> shift);
  }

  [[nodiscard]] bool areBlocksApart(std::size_t a, std::size_t b) const {
    return areApart(forest_.levels[0].cells[a], forest_.levels[0].cells[b], 3);
  }

  void mergeLevel1() {
    forBlocks([&](std::size_t i) {
      const BlockForest& block = forest_.blocks[i];
      std::uint64_t merged = block.safe1 & ~forbidden_.level1[i];
      for (const Cluster& cluster : forest_.level1(i)) {
        const int cell = cluster.cell;
        if (!keepsRule(cluster, 1, middleOf(i, 1, cell >> 4, (cell >> 2) & 3, cell & 3))) {
          merged &= ~(std::uint64_t{1} << cell);
        }
      }
      merged_.level1[i] = merged;
    });
  }

  void mergeLevel2() {
    forBlocks([&](std::size_t i) {
      const BlockForest& block = forest_.blocks[i];
      auto merged = static_cast<std::uint8_t>(block.safe2 & ~forbidden_.level2[i]);
      for (const Cluster& cluster : forest_.level2(i)) {
        const int cell = cluster.cell;
        if (!keepsRule(cluster, 2, middleOf(i, 2, cell >> 2, (cell >> 1) & 1, cell & 1))) {
          merged &= static_cast<std::uint8_t>(~(1 << cell));
        }
      }
      if (merged != 0) merged = keepBesideMerged(i, merged);
      merged_.level2[i] = merged;
    });
  }

  // Of the level-2 cells given, those whose children and their neighbours are merged.
  [[nodiscard]] std::uint8_t keepBesideMerged(std::size_t block, std::uint8_t cells) const {
    std::array<std::uint64_t, 27> unmerged{};
    std::uint64_t any = 0;
    for (int i = 0; i < 27; ++i) {
      const SurfaceBlockIndex near =
          topology_.neighbour(topology_.blocks[block], i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
      if (near == uniform::kNoSurfaceBlock || areBlocksApart(block, near)) continue;
      unmerged[i] = forest_.blocks[near].surface1 & ~merged_.level1[near];
      any |= unmerged[i];
    }
    if (any == 0) return cells;
    for (int cell = 0; cell < 8; ++cell) {
      if (((cells >> cell) & 1) == 0) continue;
      const int x = cell >> 2, y = (cell >> 1) & 1, z = cell & 1;
      for (int i = 0; i < 64; ++i) {
        // Level-1 cells from one below to one above; 4 is added to stay positive.
        const int u = 2 * x + (i >> 4) + 3, v = 2 * y + ((i >> 2) & 3) + 3, w = 2 * z + (i & 3) + 3;
        const std::uint64_t words = unmerged[(u >> 2) * 9 + (v >> 2) * 3 + (w >> 2)];
        if (((words >> cellIndex1(u & 3, v & 3, w & 3)) & 1) == 0) continue;
        cells &= static_cast<std::uint8_t>(~(1 << cell));
        break;
      }
    }
    return cells;
  }

  void mergeBlocks() {
    const Level& level = forest_.levels[0];
    forBlocks([&](std::size_t i) {
      bool merged = level.safe[i] != 0 && forbidden_.levels[0][i] == 0;
      const Vec3 middle = middleOf(i, 3, 0, 0, 0);
      for (std::uint32_t c = level.first[i]; merged && c < level.first[i + 1]; ++c) {
        merged = keepsRule(level.clusters[c], 3, middle);
      }
      for (int n = 0; merged && n < 27; ++n) {
        const int dx = n / 9 - 1, dy = n / 3 % 3 - 1, dz = n % 3 - 1;
        const SurfaceBlockIndex near = topology_.neighbour(topology_.blocks[i], dx, dy, dz);
        if (near == uniform::kNoSurfaceBlock || areBlocksApart(i, near)) continue;
        const unsigned unmerged = forest_.blocks[near].surface2 & ~unsigned{merged_.level2[near]};
        merged = (unmerged & touching(dx, dy, dz)) == 0;
      }
      merged_.levels[0][i] = merged ? 1 : 0;
    });
  }

  // The level-2 cells of the block (dx, dy, dz) away that touch this one.
  static unsigned touching(int dx, int dy, int dz) {
    unsigned cells = 0xff;
    if (dx != 0) cells &= dx < 0 ? 0xf0U : 0x0fU;
    if (dy != 0) cells &= dy < 0 ? 0xccU : 0x33U;
    if (dz != 0) cells &= dz < 0 ? 0xaaU : 0x55U;
    return cells;
  }

  void mergeUpper(std::size_t index) {
    const Level& level = forest_.levels[index];
    const Level& below = forest_.levels[index - 1];
    const std::vector<std::uint8_t>& mergedBelow = merged_.levels[index - 1];
    job_.forRanges(level.cells.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        bool merged = level.safe[i] != 0 && forbidden_.levels[index][i] == 0;
        const Coord& cell = level.cells[i];
        const double size = static_cast<double>(std::int64_t{1} << level.level);
        const Vec3 middle((cell[0] + 0.5) * size, (cell[1] + 0.5) * size, (cell[2] + 0.5) * size);
        for (std::uint32_t c = level.first[i]; merged && c < level.first[i + 1]; ++c) {
          merged = keepsRule(level.clusters[c], level.level, middle);
        }
        for (int n = 0; merged && n < 64; ++n) {
          const Coord beside(2 * cell[0] + (n >> 4) - 1, 2 * cell[1] + ((n >> 2) & 3) - 1,
                             2 * cell[2] + (n & 3) - 1);
          if (areApart(cell << 1, beside, level.level - 1)) continue;
          const std::uint32_t near = below.find(beside);
          merged = near == kNone || mergedBelow[near] != 0;
        }
        merged_.levels[index][i] = merged ? 1 : 0;
      }
    });
  }

  template <class Body>
  void forBlocks(const Body& body) {
    job_.forRanges(forest_.blocks.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  const Forest& forest_;
  const Topology& topology_;
  const CutRule& rule_;
  const CellFlags& forbidden_;
  base::Job& job_;
  CellFlags merged_;
};

}  // namespace

CellFlags::CellFlags(const Forest& forest)
    : level1(forest.blocks.size()), level2(forest.blocks.size()) {
  for (const Level& level : forest.levels) levels.emplace_back(level.cells.size());
}

CellFlags mergeCells(const Forest& forest, const Topology& topology, const CutRule& rule,
                     const CellFlags& forbidden, base::Job& job) {
  return Merger(forest, topology, rule, forbidden, job).merge();
}

std::vector<LeafCell> collectLeaves(const Forest& forest, const Topology& topology,
                                    const CellFlags& merged) {
  std::vector<std::vector<LeafCell>> byLevel(3 + forest.levels.size());
  for (std::size_t i = 0; i < forest.blocks.size(); ++i) {
    const std::uint64_t merged1 = merged.level1[i];
    const Coord& block = forest.levels[0].cells[i];
    const auto add = [&](int level, int x, int y, int z) {
      byLevel[level].push_back({{(block[0] << 3) + (x << level), (block[1] << 3) + (y << level),
                                 (block[2] << 3) + (z << level)},
                                level});
    };
    for (int x = 0; x < grid::kBlockSize; ++x) {
      base::forEachBit(topology.blocks[i].cells.slabs[x], [&](int bit) {
        const int y = bit >> 3, z = bit & 7;
        const int parent = cellIndex1(x >> 1, y >> 1, z >> 1);
        if (((merged1 >> parent) & 1) == 0) add(0, x, y, z);
      });
    }
    base::forEachBit(merged1, [&](int cell) {
      const int x = cell >> 4, y = (cell >> 2) & 3, z = cell & 3;
      const int parent = cellIndex2(x >> 1, y >> 1, z >> 1);
      if (((merged.level2[i] >> parent) & 1) == 0) add(1, x, y, z);
    });
    if (merged.levels[0][i] != 0) continue;
    base::forEachBit(merged.level2[i],
                     [&](int cell) { add(2, cell >> 2, (cell >> 1) & 1, cell & 1); });
  }
  for (std::size_t l = 0; l < forest.levels.size(); ++l) {
    const Level& level = forest.levels[l];
    for (std::size_t i = 0; i < level.cells.size(); ++i) {
      const bool below =
          !level.parentCells.empty() && merged.levels[l + 1][level.parentCells[i]] != 0;
      if (merged.levels[l][i] == 0 || below) continue;
      const Coord& cell = level.cells[i];
      byLevel[3 + l].push_back(
          {{cell[0] << level.level, cell[1] << level.level, cell[2] << level.level}, level.level});
    }
  }
  std::vector<LeafCell> leaves;
  for (const auto& cells : byLevel) leaves.insert(leaves.end(), cells.begin(), cells.end());
  return leaves;
}

}  // namespace tufa::octree
