#include "octree/cut.h"

#include <utility>

#include "base/huge_pages.h"

namespace tufa::octree {
namespace {

// Numbers the vertices of a cut. Leaf clusters are found from the largest cells down, as each
// cluster below one takes over its leaf. A leaf cluster in a cell smaller than a block has uniform
// vertices of one block only; so each block numbers its own from 0 on, in parallel, and a prefix
// sum over the blocks makes the numbers final. Cost: two passes over the uniform vertices, one over
// the clusters.
class Numbering {
 public:
  Numbering(const ClusterForest& forest, const uniform::CellTopology& topology,
            const CellFlags& merged, base::Job& job)
      : forest_(forest), topology_(topology), merged_(merged), job_(job) {}

  Cut make() {
    findLeaves();
    base::resizeLarge(cut_.vertexOf, topology_.vertexCount, job_);
    const std::size_t count = topology_.blocks.size();
    std::vector<VertexIndex> first(count + 1);
    forBlocks([&](std::size_t i) { first[i + 1] = countInBlock(i); });
    for (std::size_t i = 0; i < count; ++i) first[i + 1] += first[i];
    base::resizeLarge(cut_.clusters, first[count], job_);
    numberLargeCells();
    job_.checkCancelled(0, 1);
    forBlocks([&](std::size_t i) { numberBlock(i, first[i]); });
    return std::move(cut_);
  }

 private:
  // The leaf cluster that stands for a cluster or uniform vertex: itself or one above it.
  struct Leaf {
    std::uint8_t level = 0;  ///< 0: the cell is not merged
    std::uint32_t cluster = kNone;
  };

  void findLeaves() {
    leaves_.resize(forest_.levels.size());
    numbers_.resize(forest_.levels.size());
    for (int level = forest_.topLevel(); level >= 1; --level) {
      const ClusterLevel& own = forest_.at(level);
      std::vector<Leaf>& leaves = leaves_[level - 1];
      base::resizeLarge(leaves, own.clusters.size(), job_);
      base::resizeLarge(numbers_[level - 1], own.clusters.size(), job_);
      job_.forRanges(own.clusters.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
          numbers_[level - 1][c] = kNone;
          const Cluster& cluster = own.clusters[c];
          if (merged_.at(level)[cluster.cell] == 0) continue;
          const bool isLeaf =
              own.parentCells.empty() || merged_.at(level + 1)[own.parentCells[cluster.cell]] == 0;
          leaves[c] = isLeaf ? Leaf{static_cast<std::uint8_t>(level), static_cast<std::uint32_t>(c)}
                             : leaves_[level][cluster.parent];
        }
      });
    }
  }

  [[nodiscard]] Leaf leafOf(std::uint64_t vertex) const {
    const std::uint32_t parent = forest_.parents[vertex];
    return parent == kNone ? Leaf{} : leaves_[0][parent];
  }

  [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> verticesOf(std::size_t block) const {
    const bool last = block + 1 == topology_.blocks.size();
    return {topology_.blocks[block].firstVertex,
            last ? topology_.vertexCount : topology_.blocks[block + 1].firstVertex};
  }

  // Numbers the vertices in cells smaller than a block, from 0 on. Returns how many there are.
  VertexIndex countInBlock(std::size_t block) {
    VertexIndex count = 0;
    const auto [begin, end] = verticesOf(block);
    for (std::uint64_t v = begin; v < end; ++v) {
      const Leaf leaf = leafOf(v);
      if (leaf.level >= ClusterForest::kBlockLevel) continue;
      if (leaf.level == 0) {
        cut_.vertexOf[v] = count++;
        continue;
      }
      VertexIndex& number = numbers_[leaf.level - 1][leaf.cluster];
      if (number == kNone) number = count++;
      cut_.vertexOf[v] = number;
    }
    return count;
  }

  // Adds the count of the blocks before, and fills in the vertices of cells of a block and more.
  void numberBlock(std::size_t block, VertexIndex first) {
    const auto [begin, end] = verticesOf(block);
    for (std::uint64_t v = begin; v < end; ++v) {
      const Leaf leaf = leafOf(v);
      if (leaf.level >= ClusterForest::kBlockLevel) {
        cut_.vertexOf[v] = numbers_[leaf.level - 1][leaf.cluster];
        continue;
      }
      cut_.vertexOf[v] += first;
      const auto own = static_cast<std::uint32_t>(v);
      cut_.clusters[cut_.vertexOf[v]] = {leaf.level, leaf.level == 0 ? own : leaf.cluster};
    }
  }

  // Numbers the leaf clusters of level 3 and above, behind all others.
  void numberLargeCells() {
    for (int level = forest_.topLevel(); level >= ClusterForest::kBlockLevel; --level) {
      const std::vector<Leaf>& leaves = leaves_[level - 1];
      for (std::uint32_t c = 0; c < leaves.size(); ++c) {
        if (leaves[c].level != level) continue;
        numbers_[level - 1][c] = static_cast<VertexIndex>(cut_.clusters.size());
        cut_.clusters.push_back({leaves[c].level, c});
      }
    }
  }

  template <class Body>
  void forBlocks(const Body& body) {
    job_.forRanges(topology_.blocks.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  const ClusterForest& forest_;
  const uniform::CellTopology& topology_;
  const CellFlags& merged_;
  base::Job& job_;
  Cut cut_;
  std::vector<std::vector<Leaf>> leaves_;          ///< of each cluster, by level
  std::vector<std::vector<VertexIndex>> numbers_;  ///< of each leaf cluster, by level
};

}  // namespace

Cut makeCut(const ClusterForest& forest, const uniform::CellTopology& topology,
            const CellFlags& merged, base::Job& job) {
  return Numbering(forest, topology, merged, job).make();
}

}  // namespace tufa::octree
