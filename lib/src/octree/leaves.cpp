#include "octree/leaves.h"

#include <atomic>

#include "base/bits.h"

namespace tufa::octree {
namespace {

// Share of the tolerance that the error of a cluster, a root mean square, may take. On a curved
// patch the largest distance is about twice that; where it is more, the certificate finds it and
// the cell is split.
constexpr double kErrorShare = 0.5;

// Decides level by level, from below. A cell that is not merged blocks all cells one level up that
// it touches, its parent among them. So a cell that no smaller one blocks has all its children
// merged, and all surface cells of their size around it. Only cells that are not merged visit their
// neighbours, so flat surfaces cost next to nothing.
//
// Why the leaves are restricted: let a leaf c touch a leaf L at least two levels above. The cell
// around c one level below L is not merged, being larger than the leaf c, and it touches L; so L
// would be blocked. Why no coarser octree has the same properties: each condition asks for merged
// cells one level below only and never for cells that are not merged, so merging all that pass
// gives the largest set there is.
class Merger {
 public:
  Merger(const ClusterForest& forest, const CutRule& rule, const CellFlags& forbidden,
         base::Job& job)
      : forest_(forest), rule_(rule), forbidden_(forbidden), job_(job), merged_(forest) {}

  CellFlags merge() {
    for (int level = 1; level <= forest_.topLevel(); ++level) {
      // Until it is decided, a flag says that the cell is blocked.
      if (level > 1) blockAbove(level - 1);
      decide(level);
    }
    return std::move(merged_);
  }

 private:
  template <class Body>
  void forCells(int level, const Body& body) {
    job_.forRanges(forest_.at(level).cells.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(static_cast<std::uint32_t>(i));
    });
  }

  void decide(int level) {
    const ClusterLevel& own = forest_.at(level);
    std::vector<std::uint8_t>& merged = merged_.at(level);
    forCells(level, [&](std::uint32_t cell) {
      const bool blocked = merged[cell] != 0;
      merged[cell] =
          !blocked && own.safe[cell] != 0 && forbidden_.at(level)[cell] == 0 && keepsRule(own, cell)
              ? 1
              : 0;
    });
  }

  [[nodiscard]] bool keepsRule(const ClusterLevel& level, std::uint32_t cell) const {
    if (level.level > rule_.maxLevel) return false;
    if (level.level <= rule_.minLevel) return true;
    const double size = static_cast<double>(std::int64_t{1} << level.level);
    const Coord& at = level.cells[cell];
    const Vec3 middle = Vec3(at[0] + 0.5, at[1] + 0.5, at[2] + 0.5) * size;
    for (std::uint32_t c = level.first[cell]; c < level.first[cell + 1]; ++c) {
      const Cluster& cluster = level.clusters[c];
      const Vec3 point(cluster.point[0], cluster.point[1], cluster.point[2]);
      const double tolerance = rule_.toleranceAt(middle + point);
      if (!(tolerance > 0 && cluster.error <= kErrorShare * tolerance &&
            cluster.angle <= rule_.maxAngle)) {
        return false;
      }
    }
    return true;
  }

  // Several cells may block the same one at the same time; all write 1, so the result is the same
  // for any number of threads.
  void blockAbove(int level) {
    const ClusterLevel& own = forest_.at(level);
    std::vector<std::uint8_t>& blocked = merged_.at(level + 1);
    forCells(level, [&](std::uint32_t cell) {
      if (merged_.at(level)[cell] != 0) return;
      const Coord& at = own.cells[cell];
      // A cell touches exactly eight cells of twice its size, those around the corner that it
      // shares with its parent.
      const Coord lower = at.offsetBy(-1) >> 1;
      for (int i = 0; i < 8; ++i) {
        const Coord above = lower.offsetBy(i >> 2, (i >> 1) & 1, i & 1);
        const std::uint32_t touched = forest_.find(level + 1, above);
        if (touched == kNone) continue;
        std::atomic_ref<std::uint8_t>(blocked[touched]).store(1, std::memory_order_relaxed);
      }
    });
  }

  const ClusterForest& forest_;
  const CutRule& rule_;
  const CellFlags& forbidden_;
  base::Job& job_;
  CellFlags merged_;
};

}  // namespace

CellFlags::CellFlags(const ClusterForest& forest) {
  for (const ClusterLevel& level : forest.levels) levels.emplace_back(level.cells.size());
}

CellFlags mergeCells(const ClusterForest& forest, const CutRule& rule, const CellFlags& forbidden,
                     base::Job& job) {
  return Merger(forest, rule, forbidden, job).merge();
}

std::vector<LeafCell> collectLeaves(const ClusterForest& forest,
                                    const uniform::CellTopology& topology,
                                    const CellFlags& merged) {
  std::vector<LeafCell> leaves;
  for (std::uint32_t block = 0; block < topology.blocks.size(); ++block) {
    const Coord origin = forest.at(ClusterForest::kBlockLevel).corner(block);
    for (int x = 0; x < grid::kBlockSize; ++x) {
      base::forEachBit(topology.blocks[block].cells.slabs[x], [&](int bit) {
        const Coord local(x, bit >> 3, bit & 7);
        const std::uint32_t parent =
            forest.findInBlock(1, block, ClusterForest::slotInBlock(1, local >> 1));
        if (merged.at(1)[parent] == 0) leaves.push_back({origin + local, 0});
      });
    }
  }
  for (const ClusterLevel& level : forest.levels) {
    const std::vector<std::uint8_t>& own = merged.at(level.level);
    for (std::uint32_t i = 0; i < level.cells.size(); ++i) {
      const bool below =
          !level.parentCells.empty() && merged.at(level.level + 1)[level.parentCells[i]] != 0;
      if (own[i] != 0 && !below) leaves.push_back({level.corner(i), level.level});
    }
  }
  return leaves;
}

}  // namespace tufa::octree
