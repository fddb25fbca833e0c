#include "extract/octree_mc.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/huge_pages.h"
#include "extract/block_triangles.h"
#include "extract/cube_cells.h"
#include "extract/cube_mesher.h"
#include "extract/marching_cubes.h"
#include "extract/merged_leaves.h"
#include "extract/place_crossings.h"
#include "grid/samples.h"
#include "uniform/crossings.h"
#include "uniform/uniform_surface.h"

namespace tufa::extraction {

using grid::BlockSamples;
using grid::kBlockSize;
using uniform::SurfaceBlock;

namespace {

class OctreeMesher {
 public:
  OctreeMesher(const grid::Volume& volume, const ContourOptions& options, base::Job& job)
      : volume_(volume),
        options_(options),
        rule_(marchingCubesRule(options.ambiguity)),
        job_(job) {}

  Mesh run(ContourReport& report) {
    job_.beginStage("cells", kCellsEnd);
    topology_ = uniform::findSurfaceCells(volume_.blocks, volume_.scale, options_.cap, job_);
    report = uniform::reportOf(volume_, topology_);
    addBlocksBeside();
    job_.beginStage("leaves", kLeavesEnd);
    leaves_ = mergeSamples(volume_, topology_, options_.tolerance, job_);
    job_.beginStage("vertices", kVerticesEnd);
    findEdges();
    const std::uint64_t count = numberEdges(edges_, job_);
    uniform::requireIndexable(count);
    Mesh mesh;
    base::resizeLarge(mesh.positions, count, job_);
    base::resizeLarge(mesh.normals, count, job_);
    placeVertices(mesh);
    job_.beginStage("triangles", kTrianglesEnd);
    emit(mesh);
    dropUnused(mesh, job_);
    return mesh;
  }

 private:
  // Shares of the time that stages took on the sample volumes.
  static constexpr double kCellsEnd = 0.2, kLeavesEnd = 0.6, kVerticesEnd = 0.8,
                          kTrianglesEnd = 0.95;

  /// Adds the blocks next to surface blocks: leaves of these may bring surface into them.
  void addBlocksBeside() {
    const auto accessor = volume_.blocks.accessor();
    const std::size_t count = topology_.blocks.size();
    for (std::size_t i = 0; i < count; ++i) {
      job_.pollCancelled(i);
      for (const grid::BlockRef beside : grid::Neighbours(topology_.blocks[i].neighbours)) {
        if (beside < 0 || topology_.surfaceBlockOf[beside] != uniform::kNoSurfaceBlock) continue;
        topology_.surfaceBlockOf[beside] =
            static_cast<uniform::SurfaceBlockIndex>(topology_.blocks.size());
        SurfaceBlock block;
        block.block = beside;
        block.neighbours = volume_.blocks.neighbours(beside, *accessor);
        topology_.blocks.push_back(block);
      }
    }
  }

  /// A leaf as its neighbours see it: one that was merged, or a single sample.
  struct Leaf {
    const MergedLeaf* merged = nullptr;
    Vec3 moved{0.0};  ///< its block, in samples from the block at hand

    [[nodiscard]] int level() const { return merged == nullptr ? 0 : merged->level; }
  };

  /// The leaf of a sample 0..8 steps from a block on each axis.
  [[nodiscard]] Leaf leafAt(const SurfaceBlock& block, int x, int y, int z) const {
    const int dx = x >> 3, dy = y >> 3, dz = z >> 3;
    const auto index = topology_.neighbour(block, dx, dy, dz);
    if (index == uniform::kNoSurfaceBlock) return {};
    return {leaves_[index].leafAt(x & 7, y & 7, z & 7),
            Vec3(dx * kBlockSize, dy * kBlockSize, dz * kBlockSize)};
  }

  /// The lattice edge that stands for the dual edge of another: the first one between the same two
  /// leaves.
  [[nodiscard]] std::array<int, 3> firstBetween(const SurfaceBlock& block, std::array<int, 3> at,
                                                int axis) const {
    std::array<int, 3> upper = at;
    ++upper[axis];
    const int level = std::min(leafAt(block, at[0], at[1], at[2]).level(),
                               leafAt(block, upper[0], upper[1], upper[2]).level());
    for (int other = 0; other < 3; ++other) {
      if (other != axis) at[other] = at[other] >> level << level;
    }
    return at;
  }

  [[nodiscard]] grid::CornerWords cornersOf(const SurfaceBlock& block) const {
    return grid::cornerWordsOf([&](int dx, int dy, int dz, int x) {
      const auto index = topology_.neighbour(block, dx, dy, dz);
      if (index != uniform::kNoSurfaceBlock) return leaves_[index].inside.slabs[x];
      const grid::BlockRef beside = block.neighbours[grid::neighbourIndex(dx, dy, dz)];
      if (beside >= 0) return volume_.blocks.inside(beside).slabs[x];
      return beside == grid::kInsideTile ? ~std::uint64_t{0} : std::uint64_t{0};
    });
  }

  /// Calls body(block, index) for each surface block.
  template <class NewBody>
  void forBlocks(const NewBody& newBody) {
    job_.forRanges(topology_.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
      auto body = newBody();
      for (std::size_t i = begin; i < end; ++i) body(topology_.blocks[i], i);
    });
  }

  void findEdges() {
    edges_.resize(topology_.blocks.size());
    forBlocks([&] {
      return [&](const SurfaceBlock& block, std::size_t i) {
        const grid::CornerWords corners = cornersOf(block);
        for (int x = 0; x < kBlockSize; ++x) {
          const auto crossed = uniform::crossedEdges(corners, x);
          for (int axis = 0; axis < 3; ++axis) {
            const std::uint64_t open =
                block.special < 0 ? 0 : topology_.specials[block.special].cut[axis].slabs[x];
            base::forEachBit(crossed[axis] & ~open, [&](int bit) {
              const std::array<int, 3> at = {x, bit >> 3, bit & 7};
              if (firstBetween(block, at, axis) != at) return;
              edges_[i].crossed[axis].set(x * 64 + bit);
            });
          }
        }
        edges_[i].countEdges();
      };
    });
  }

  void placeVertices(Mesh& mesh) {
    forBlocks([&] {
      return [&, accessor = std::shared_ptr<grid::Accessor>(volume_.blocks.accessor()),
              samples = BlockSamples()](const SurfaceBlock& block, std::size_t i) mutable {
        if (edges_[i].count == 0) return;
        samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, *accessor);
        auto vertex = static_cast<std::size_t>(edges_[i].first);
        forEdges(edges_[i], [&](int axis, int x, int bit) {
          place(block, {x, bit >> 3, bit & 7}, axis, samples, vertex++, mesh);
        });
      };
    });
  }

  void place(const SurfaceBlock& block, const std::array<int, 3>& at, int axis,
             const BlockSamples& samples, std::size_t vertex, Mesh& mesh) const {
    std::array<int, 3> upper = at;
    ++upper[axis];
    const Leaf a = leafAt(block, at[0], at[1], at[2]);
    const Leaf b = leafAt(block, upper[0], upper[1], upper[2]);
    const int lowest = BlockSamples::index(at[0], at[1], at[2]);
    Vec3 point(at[0], at[1], at[2]);
    uniform::Vector gradient{};
    if (a.merged == nullptr && b.merged == nullptr) {
      const uniform::CrossingFinder finder(samples, volume_.scale);
      const uniform::Crossing crossing = axis == 0   ? finder.at<0>(lowest)
                                         : axis == 1 ? finder.at<1>(lowest)
                                                     : finder.at<2>(lowest);
      point[axis] += static_cast<double>(crossing.along);
      gradient = crossing.normal;
    } else {
      const double step = static_cast<double>(samples[lowest + BlockSamples::stride(axis)]);
      const Vec3 to(upper[0], upper[1], upper[2]);
      const Vec3 from = centreOf(a, point), end = centreOf(b, to);
      const double first = valueOf(a, static_cast<double>(samples[lowest]), b, from);
      const double last = valueOf(b, step, a, end);
      using Finder = uniform::CrossingFinder;
      const float along = Finder::keptOffEnds(
          Finder::linearRoot(static_cast<float>(first), static_cast<float>(last)));
      point = from + (end - from) * static_cast<double>(along);
      for (int i = 0; i < 3; ++i) {
        const float low = a.merged != nullptr ? a.merged->gradient[i] : b.merged->gradient[i];
        const float high = b.merged != nullptr ? b.merged->gradient[i] : low;
        gradient[i] = low + along * (high - low);
      }
    }
    const Coord& origin = volume_.blocks.origin(block.block);
    mesh.positions[vertex] = volume_.affine.position(origin, point[0], point[1], point[2]);
    mesh.normals[vertex] = volume_.affine.normal(gradient[0], gradient[1], gradient[2]);
  }

  [[nodiscard]] static Vec3 centreOf(const Leaf& leaf, const Vec3& sample) {
    return leaf.merged == nullptr ? sample : leaf.merged->centre() + leaf.moved;
  }

  /// The value at the centre of a leaf. That of a sample beyond the band of a level set comes from
  /// the leaf beside it, if that is of the same sign.
  [[nodiscard]] double valueOf(const Leaf& leaf, double sample, const Leaf& beside,
                               const Vec3& centre) const {
    if (leaf.merged != nullptr) return static_cast<double>(leaf.merged->value);
    const grid::FieldScale& scale = volume_.scale;
    const auto single = static_cast<float>(sample);
    if (single > scale.bandInside && single < scale.bandOutside) return sample;
    const double continued = beside.merged->valueAt(centre - beside.moved);
    return (continued < 0) == (sample < 0) ? continued : sample;
  }

  [[nodiscard]] CaseCode codeAt(const SurfaceBlock& block, int cell, CornerMask mask,
                                const BlockSamples& samples) const {
    if (mask == 0 || mask == 0xff) return 0;
    if (topology_.openEdges > 0 && topology_.openEdgesOf(block, cell) != 0) return 0;
    if (!rule_.asks[mask]) return rule_.codes[mask];
    CornerValues values;
    for (int corner = 0; corner < kCorners; ++corner) {
      const int x = (cell >> 6) + (corner >> 2), y = ((cell >> 3) & 7) + ((corner >> 1) & 1),
                z = (cell & 7) + (corner & 1);
      const Leaf leaf = leafAt(block, x, y, z);
      values[corner] =
          leaf.merged != nullptr ? leaf.merged->value : samples[BlockSamples::index(x, y, z)];
    }
    return rule_.decide(mask, values);
  }

  void emit(Mesh& mesh) {
    std::vector<BlockTriangles> parts(topology_.blocks.size());
    forBlocks([&] {
      return [&, accessor = std::shared_ptr<grid::Accessor>(volume_.blocks.accessor()),
              samples = BlockSamples(),
              table = CubeTable()](const SurfaceBlock& block, std::size_t i) mutable {
        samples.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, *accessor);
        table.fill(topology_, block, edges_);
        emit(block, samples, table, mesh, parts[i]);
      };
    });
    appendBlocks(parts, mesh.positions.size(), mesh);
  }

  void emit(const SurfaceBlock& block, const BlockSamples& samples, const CubeTable& table,
            const Mesh& mesh, BlockTriangles& out) const {
    const grid::CornerWords corners = cornersOf(block);
    const int second = volume_.affine.mirrored() ? 2 : 1;
    for (int cell = 0; cell < grid::kBlockCells; ++cell) {
      const CaseCode code = codeAt(block, cell, uniform::cornerMask(corners, cell), samples);
      if (code == 0) continue;
      const CubeCase& chosen = caseOf(code);
      const std::array<VertexIndex, kEdges> vertices = verticesOf(block, cell, chosen, table);
      const auto firstCentre =
          static_cast<VertexIndex>(mesh.positions.size() + out.positions.size());
      const auto vertexOf = [&](std::uint8_t corner) {
        return corner < kEdges ? vertices[corner] : firstCentre + (corner - kCentre);
      };
      for (int i = 0; i < chosen.count; ++i) {
        const auto& t = chosen.triangles[i];
        const VertexIndex a = vertexOf(t[0]), b = vertexOf(t[second]), c = vertexOf(t[3 - second]);
        if (a != b && b != c && c != a) out.triangles.emplace_back(a, b, c);
      }
      for (int i = 0; i < chosen.centreCount; ++i) {
        addCentre(chosen.aroundCentre[i], vertices, mesh, out);
      }
    }
  }

  [[nodiscard]] std::array<VertexIndex, kEdges> verticesOf(const SurfaceBlock& block, int cell,
                                                           const CubeCase& chosen,
                                                           const CubeTable& table) const {
    std::array<VertexIndex, kEdges> vertices{};
    for (int edge = 0; edge < kEdges; ++edge) {
      if (chosen.next[edge] < 0) continue;
      const int lower = uniform::edgeCorners(edge)[0], axis = edge / 4;
      const std::array<int, 3> at = {(cell >> 6) + (lower >> 2),
                                     ((cell >> 3) & 7) + ((lower >> 1) & 1),
                                     (cell & 7) + (lower & 1)};
      const auto first = firstBetween(block, at, axis);
      vertices[edge] = table[CubeTable::offsetOf(axis, 0, 0, 0) +
                             CubeTable::placeOf(first[0], first[1], first[2])];
    }
    return vertices;
  }

  static void addCentre(unsigned around, const std::array<VertexIndex, kEdges>& vertices,
                        const Mesh& mesh, BlockTriangles& out) {
    Vec3 sum(0), normal(0);
    int count = 0;
    base::forEachBit(around, [&](int edge) {
      sum += Vec3(mesh.positions[vertices[edge]]);
      normal += Vec3(mesh.normals[vertices[edge]]);
      ++count;
    });
    if (!normal.normalize()) normal = Vec3(mesh.normals[vertices[std::countr_zero(around)]]);
    out.positions.push_back(sum / count);
    out.normals.push_back(Normal(normal));
  }

  const grid::Volume& volume_;
  const ContourOptions& options_;
  CubeRule rule_;
  base::Job& job_;
  uniform::CellTopology topology_;
  std::vector<BlockLeaves> leaves_;  ///< of each surface block
  std::vector<CubeEdges> edges_;     ///< of each surface block: one for each dual edge
};

}  // namespace

Mesh meshOctree(const grid::Volume& volume, const ContourOptions& options, ContourReport& report,
                base::Job& job) {
  return OctreeMesher(volume, options, job).run(report);
}

}  // namespace tufa::extraction
