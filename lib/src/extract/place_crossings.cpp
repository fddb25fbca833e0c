#include "extract/place_crossings.h"

#include <algorithm>

#include "base/huge_pages.h"
#include "grid/samples.h"
#include "uniform/crossings.h"

namespace tufa::extraction {

using grid::BlockSamples;
using uniform::CrossingBatch;

namespace {

class CrossingPlacer {
 public:
  CrossingPlacer(const grid::Volume& volume, Mesh& mesh)
      : volume_(volume), mesh_(mesh), finder_(samples_, volume.scale) {}

  void place(const uniform::SurfaceBlock& block, const BlockEdges<3>& edges,
             grid::Accessor& accessor) {
    if (edges.count == 0) return;
    samples_.gather(volume_.blocks, volume_.scale, block.block, block.neighbours, accessor);
    origin_ = volume_.blocks.origin(block.block);
    auto vertex = static_cast<std::size_t>(edges.first);
    placeAlong<0>(edges, vertex);
    placeAlong<1>(edges, vertex);
    placeAlong<2>(edges, vertex);
  }

 private:
  template <int axis>
  void placeAlong(const BlockEdges<3>& edges, std::size_t& vertex) {
    int count = 0;
    for (int x = 0; x < grid::kBlockSize; ++x) {
      base::forEachBit(edges.crossed[axis].slabs[x], [&](int bit) {
        starts_[count++] = static_cast<std::uint16_t>(x * 64 + bit);
      });
    }
    for (int first = 0; first < count; first += CrossingBatch::kSize) {
      const int lanes = std::min(count - first, CrossingBatch::kSize);
      placeBatch<axis>(&starts_[first], lanes, vertex);
      vertex += static_cast<std::size_t>(lanes);
    }
  }

  template <int axis>
  void placeBatch(const std::uint16_t* starts, int lanes, std::size_t vertex) {
    // The last edge fills the places that are left over.
    for (int lane = 0; lane < CrossingBatch::kSize; ++lane) {
      const int start = starts[std::min(lane, lanes - 1)];
      batch_.lower[lane] =
          static_cast<std::uint16_t>(BlockSamples::index(start >> 6, (start >> 3) & 7, start & 7));
    }
    finder_.findAll<axis>(batch_);
    for (int lane = 0; lane < lanes; ++lane) {
      const int start = starts[lane];
      std::array<double, 3> at = {static_cast<double>(start >> 6),
                                  static_cast<double>((start >> 3) & 7),
                                  static_cast<double>(start & 7)};
      at[axis] += static_cast<double>(batch_.along[lane]);
      const std::size_t to = vertex + static_cast<std::size_t>(lane);
      mesh_.positions[to] = volume_.affine.position(origin_, at[0], at[1], at[2]);
      if (mesh_.normals.empty()) continue;
      mesh_.normals[to] = volume_.affine.normal(batch_.normals[0][lane], batch_.normals[1][lane],
                                                batch_.normals[2][lane]);
    }
  }

  const grid::Volume& volume_;
  Mesh& mesh_;
  BlockSamples samples_;
  uniform::CrossingFinder finder_;
  CrossingBatch batch_;
  Coord origin_;
  std::array<std::uint16_t, grid::kBlockCells> starts_;
};

}  // namespace

void placeCrossings(const grid::Volume& volume, const uniform::CellTopology& topology,
                    const std::vector<BlockEdges<3>>& edges, Mesh& mesh, base::Job& job) {
  job.forRanges(topology.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
    const auto accessor = volume.blocks.accessor();
    CrossingPlacer placer(volume, mesh);
    for (std::size_t i = begin; i < end; ++i) placer.place(topology.blocks[i], edges[i], *accessor);
  });
}

Mesh meshOfCrossings(const grid::Volume& volume, const CubeCells& cells, base::Job& job) {
  Mesh mesh;
  base::resizeLarge(mesh.positions, cells.edgeCount, job);
  base::resizeLarge(mesh.normals, cells.edgeCount, job);
  placeCrossings(volume, cells.topology, cells.edges, mesh, job);
  return mesh;
}

void dropUnused(Mesh& mesh, base::Job& job) {
  std::vector<VertexIndex> moved(mesh.positions.size(), 0);
  for (const Triangle& triangle : mesh.triangles) {
    for (const VertexIndex vertex : triangle.vertices) moved[vertex] = 1;
  }
  VertexIndex kept = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    job.pollCancelled(i);
    const bool used = moved[i] != 0;
    moved[i] = kept;
    if (!used) continue;
    mesh.positions[kept] = mesh.positions[i];
    if (!mesh.normals.empty()) mesh.normals[kept] = mesh.normals[i];
    ++kept;
  }
  mesh.positions.resize(kept);
  if (!mesh.normals.empty()) mesh.normals.resize(kept);
  job.forRanges(mesh.triangles.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (VertexIndex& vertex : mesh.triangles[i].vertices) vertex = moved[vertex];
    }
  });
}

}  // namespace tufa::extraction
