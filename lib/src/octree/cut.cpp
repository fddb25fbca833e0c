#include "octree/cut.h"

#include "base/huge_pages.h"

namespace tufa::octree {

using uniform::SurfaceBlock;
using uniform::Topology;

namespace {

// Numbers the vertices of a cut.
class Numbering {
 public:
  Numbering(const Forest& forest, const Topology& topology, const CellFlags& merged, base::Job& job)
      : forest_(forest), topology_(topology), merged_(merged), job_(job) {}

  Cut make() {
    const std::size_t count = forest_.blocks.size();
    std::vector<VertexIndex> first(count + 1);
    forBlocks([&](std::size_t i) { first[i + 1] = countVertices(i); });
    for (std::size_t i = 0; i < count; ++i) first[i + 1] += first[i];
    cut_.clusters.resize(first[count]);
    numberUpper();
    job_.look(0, 1);
    base::resizeLarge(cut_.vertexOf, topology_.vertexCount, job_);
    forBlocks([&](std::size_t i) { numberBlock(i, first[i]); });
    return std::move(cut_);
  }

 private:
  // Calls body(i, level, cluster) for each base vertex of a block, with the cluster it belongs to.
  // Level 3 stands for all above: the cluster is one of forest levels[0].
  template <class Body>
  void forVertices(std::size_t index, const Body& body) const {
    const auto parents = forest_.parents(index);
    const auto level1 = forest_.level1(index), level2 = forest_.level2(index);
    const std::uint64_t merged1 = merged_.level1[index];
    const unsigned merged2 = merged_.level2[index];
    const bool merged3 = merged_.levels[0][index] != 0;
    for (std::uint32_t i = 0; i < parents.size(); ++i) {
      const std::uint16_t parent1 = parents[i];
      if (parent1 == BlockGroup::kNoParent || ((merged1 >> level1[parent1].cell) & 1) == 0) {
        body(i, 0, i);
        continue;
      }
      const std::uint32_t parent2 = level1[parent1].parent;
      if (parent2 == kNone || ((merged2 >> level2[parent2].cell) & 1) == 0) {
        body(i, 1, std::uint32_t{parent1});
      } else if (!merged3) {
        body(i, 2, parent2);
      } else {
        body(i, 3, level2[parent2].parent);
      }
    }
  }

  [[nodiscard]] VertexIndex countVertices(std::size_t index) const {
    const BlockForest& block = forest_.blocks[index];
    std::vector<std::uint8_t> seen1(block.clusters1), seen2(block.clusters2);
    VertexIndex count = 0;
    forVertices(index, [&](std::uint32_t, int level, std::uint32_t cluster) {
      if (level == 3) return;
      std::uint8_t none = 0;
      std::uint8_t& seen = level == 1 ? seen1[cluster] : level == 2 ? seen2[cluster] : none;
      if (seen == 0) ++count;
      seen = 1;
    });
    return count;
  }

  // Leaf clusters of level 3 and above, and with them those below that they stand for.
  void numberUpper() {
    const std::vector<Level>& levels = forest_.levels;
    upper_.resize(levels.size());
    for (std::size_t l = levels.size(); l-- > 0;) {
      const Level& level = levels[l];
      upper_[l].assign(level.clusters.size(), kNone);
      for (std::uint32_t cell = 0; cell < level.cells.size(); ++cell) {
        if (merged_.levels[l][cell] == 0) continue;
        const bool leaf =
            level.parentCells.empty() || merged_.levels[l + 1][level.parentCells[cell]] == 0;
        for (std::uint32_t c = level.first[cell]; c < level.first[cell + 1]; ++c) {
          if (!leaf) {
            upper_[l][c] = upper_[l + 1][level.clusters[c].parent];
            continue;
          }
          upper_[l][c] = static_cast<VertexIndex>(cut_.clusters.size());
          cut_.clusters.push_back({static_cast<std::uint8_t>(level.level), 0, cell, c});
        }
      }
    }
  }

  void numberBlock(std::size_t index, VertexIndex next) {
    const auto level1 = forest_.level1(index), level2 = forest_.level2(index);
    const SurfaceBlock& surface = topology_.blocks[index];
    std::vector<VertexIndex> number1(level1.size(), kNone);
    std::vector<VertexIndex> number2(level2.size(), kNone);
    const auto parent = static_cast<std::uint32_t>(index);
    forVertices(index, [&](std::uint32_t i, int level, std::uint32_t cluster) {
      VertexIndex& vertex = cut_.vertexOf[surface.firstVertex + i];
      if (level == 3) {
        vertex = upper_[0][cluster];
        return;
      }
      if (level == 0) {
        vertex = next++;
        cut_.clusters[vertex] = {0, 0, parent, static_cast<std::uint32_t>(surface.firstVertex + i)};
        return;
      }
      VertexIndex& number = level == 1 ? number1[cluster] : number2[cluster];
      if (number == kNone) {
        number = next++;
        const std::uint16_t cell = level == 1 ? level1[cluster].cell : level2[cluster].cell;
        cut_.clusters[number] = {static_cast<std::uint8_t>(level), cell, parent, cluster};
      }
      vertex = number;
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
  const CellFlags& merged_;
  base::Job& job_;
  Cut cut_;
  std::vector<std::vector<VertexIndex>> upper_;  ///< vertex of each cluster of level 3 and above
};

}  // namespace

Cut makeCut(const Forest& forest, const Topology& topology, const CellFlags& merged,
            base::Job& job) {
  return Numbering(forest, topology, merged, job).make();
}

}  // namespace tufa::octree
