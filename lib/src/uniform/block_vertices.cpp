#include "uniform/block_vertices.h"

#include <algorithm>

#include "base/bits.h"

namespace tufa::uniform {

using grid::BlockSamples;
using grid::CornerWords;
using grid::kBlockSize;

namespace {

// Vertices keep this distance from the faces of their cell, so that no two of different cells
// coincide.
constexpr float kHalfCell = 0.499F;
// A mean normal shorter than this is that of several sheets (two of equal weight, 30 degrees
// apart).
constexpr float kOneSide = 0.966F;

using Kind = VertexSheets::Kind;

// What is known of a vertex before it is placed: the sheets beside a sharp kink are unknown.
Kind kindAt(Kink kink) { return kink == Kink::Sharp ? Kind::Unknown : Kind::Near; }

// Whether the planes of a QEF seem to belong to one smooth sheet.
Kind kindOf(const Qef& qef) {
  const float squared = dot(qef.normals, qef.normals);
  return squared < kOneSide * kOneSide * qef.count * qef.count ? Kind::Unknown : Kind::Near;
}

int slotOf(int cell) { return BlockSamples::index(cell >> 6, (cell >> 3) & 7, cell & 7); }

// Lattice points of the slots, in voxels from the block's first.
constexpr auto kPointOf = [] {
  constexpr int kSize = BlockSamples::kSize;
  std::array<Vector, kSize * kSize * kSize> points{};
  for (int i = 0; i < kSize * kSize * kSize; ++i) {
    points[i] = {static_cast<float>(i / BlockSamples::kStrideX - 1),
                 static_cast<float>(i / BlockSamples::kStrideY % kSize - 1),
                 static_cast<float>(i % kSize - 1)};
  }
  return points;
}();

// Slots of the lattice points of a slab, counted from its first.
constexpr auto kSlotInSlab = [] {
  std::array<std::uint16_t, 64> slots{};
  for (int bit = 0; bit < 64; ++bit) {
    slots[bit] = static_cast<std::uint16_t>((bit >> 3) * BlockSamples::kStrideY + (bit & 7));
  }
  return slots;
}();

}  // namespace

void BlockVertices::place(const grid::Blocks& blocks, const CellTopology& topology,
                          const SurfaceBlock& block, grid::Accessor& accessor) {
  gather(blocks, topology, block, accessor);
  solveVertices(blocks.origin(block.block), accessor);
}

void BlockVertices::gather(const grid::Blocks& blocks, const CellTopology& topology,
                           const SurfaceBlock& block, grid::Accessor& accessor) {
  const CornerWords corners = blocks.cornerWords(block.neighbours);
  samples_.gather(blocks, scale_, block.block, block.neighbours, accessor);
  numberVertices(topology, block, corners);
  isPart_ = false;
  addAllEdges(corners);
}

void BlockVertices::gatherFor(std::span<const VertexIndex> vertices, const grid::Blocks& blocks,
                              const CellTopology& topology, const SurfaceBlock& block,
                              grid::Accessor& accessor) {
  const CornerWords corners = blocks.cornerWords(block.neighbours);
  samples_.gather(blocks, scale_, block.block, block.neighbours, accessor);
  numberVertices(topology, block, corners);
  isPart_ = true;
  grid::BlockBits wanted{};
  for (const VertexIndex vertex : vertices) wanted.set(cells_[vertex]);
  for (const std::uint16_t cell : cells_) {
    if (!wanted.get(cell)) firstVertexOf_[slotOf(cell)] = kNobody;
  }
  addAllEdges(corners);
}

void BlockVertices::addAllEdges(const CornerWords& corners) {
  addEdges<0>(corners);
  addEdges<1>(corners);
  addEdges<2>(corners);
}

void BlockVertices::numberVertices(const CellTopology& topology, const SurfaceBlock& block,
                                   const CornerWords& corners) {
  special_ = block.special >= 0;
  firstVertexOf_.fill(kNobody);
  cells_.clear();
  centers_.clear();
  for (int x = 0; x < kBlockSize; ++x) {
    base::forEachBit(block.cells.slabs[x], [&](int bit) {
      const int cell = x * 64 + bit;
      const int slot = slotOf(cell);
      firstVertexOf_[slot] = static_cast<std::uint16_t>(cells_.size() + 1);
      int count = 1;
      if (special_) {
        componentsOf_[slot] = topology.componentsAt(block, cell, cornerMask(corners, cell));
        openEdgesOf_[slot] = static_cast<std::uint16_t>(topology.openEdgesOf(block, cell));
        count = componentsOf_[slot].count();
      }
      const Vector& corner = kPointOf[slot];
      for (; count > 0; --count) {
        cells_.push_back(static_cast<std::uint16_t>(cell));
        centers_.push_back({corner[0] + 0.5F, corner[1] + 0.5F, corner[2] + 0.5F});
      }
    });
  }
  qefs_.assign(cells_.size() + 1, {});
  kinds_.assign(cells_.size(), Kind::Smooth);
  meetings_.clear();
  outOfCell_.clear();
}

// Every crossed edge of the block's cells along one axis, those on its upper faces included.
template <int axis>
void BlockVertices::collectEdges(const CornerWords& corners) {
  constexpr std::uint64_t kLastY = std::uint64_t{0xff} << 56;
  constexpr std::uint64_t kLastZ = 0x8080808080808080u;
  edgeCount_ = 0;
  for (int x = 0; x < kBlockSize + (axis == 0 ? 0 : 1); ++x) {
    const auto& w = corners.words[x];
    // Word i is the lattice points (y + i / 2, z + i % 2).
    const auto add = [&](int i, std::uint64_t crossed) {
      const int first = BlockSamples::index(x, i / 2, i % 2);
      base::forEachBit(crossed, [&](int bit) {
        edges_[edgeCount_++] = static_cast<std::uint16_t>(first + kSlotInSlab[bit]);
      });
    };
    const auto crossedAt = [&](int i) {
      return w[i] ^ (axis == 0 ? corners.words[x + 1][i] : w[i + (axis == 1 ? 2 : 1)]);
    };
    add(0, crossedAt(0));
    if (axis != 2) add(1, crossedAt(1) & kLastZ);
    if (axis != 1) add(2, crossedAt(2) & kLastY);
    if (axis == 0) add(3, crossedAt(3) & kLastY & kLastZ);
  }
}

template <int axis>
void BlockVertices::dropEdgesOfNobody() {
  constexpr auto kOther = otherAxes(axis);
  constexpr int kBack0 = BlockSamples::stride(kOther[0]), kBack1 = BlockSamples::stride(kOther[1]);
  int kept = 0;
  for (int i = 0; i < edgeCount_; ++i) {
    const int cell = edges_[i];
    edges_[kept] = edges_[i];
    kept += firstVertexOf_[cell] != kNobody || firstVertexOf_[cell - kBack0] != kNobody ||
                    firstVertexOf_[cell - kBack1] != kNobody ||
                    firstVertexOf_[cell - kBack0 - kBack1] != kNobody
                ? 1
                : 0;
  }
  edgeCount_ = kept;
}

template <int axis>
void BlockVertices::addEdges(const CornerWords& corners) {
  collectEdges<axis>(corners);
  if (isPart_) dropEdgesOfNobody<axis>();
  CrossingBatch batch;
  for (int first = 0; first < edgeCount_; first += CrossingBatch::kSize) {
    const int count = std::min(edgeCount_ - first, CrossingBatch::kSize);
    const std::uint16_t* slots = &edges_[first];
    // The last edge fills the places that are left over.
    for (int lane = 0; lane < CrossingBatch::kSize; ++lane) {
      batch.lower[lane] = slots[std::min(lane, count - 1)];
    }
    finder_.findAll<axis>(batch);
    for (int lane = 0; lane < count; ++lane) {
      Vector point = kPointOf[slots[lane]];
      point[axis] += batch.along[lane];
      planes_[lane] =
          Qef(point, {batch.normals[0][lane], batch.normals[1][lane], batch.normals[2][lane]});
    }
    for (int lane = 0; lane < count; ++lane) {
      addCrossing<axis>(slots[lane], planes_[lane], batch.kinks[lane]);
    }
  }
}

// Adds a crossing's plane to the vertices that own it in the four cells around its edge.
template <int axis>
void BlockVertices::addCrossing(int slot, const Qef& plane, Kink kink) {
  constexpr auto kOther = otherAxes(axis);
  constexpr std::array<int, 2> kBack = {BlockSamples::stride(kOther[0]),
                                        BlockSamples::stride(kOther[1])};
  for (int side = 0; side < 4; ++side) {
    // The edge is number `side` of this cell: at the cell's upper end of the first other axis if
    // bit 1 is set, of the second if bit 0 is.
    const int cell = slot - (side >> 1) * kBack[0] - (side & 1) * kBack[1];
    int vertex = firstVertexOf_[cell];
    if (special_ && vertex != kNobody) {
      const int edge = axis * 4 + side;
      if (((openEdgesOf_[cell] >> edge) & 1) != 0) continue;
      vertex += componentsOf_[cell].of(edge);
    }
    qefs_[vertex] += plane;
    if (kink != Kink::None && vertex != kNobody) {
      kinds_[vertex - 1] = std::max(kinds_[vertex - 1], kindAt(kink));
    }
  }
}

void BlockVertices::solveVertices(const Coord& origin, grid::Accessor& accessor) {
  const SampleBalls balls(scale_, accessor, origin);
  points_.resize(cells_.size());
  normals_.resize(cells_.size());
  solveAll(qefs_.data() + 1, centers_.data(), cells_.size(), kHalfCell, points_.data());
  for (std::size_t i = 0; i < cells_.size(); ++i) normals_[i] = qefs_[i + 1].normals;
  bool fresh = true;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (kinds_[i] == Kind::Smooth) continue;
    // Facets of a scan. Their planes are as good as any that could be found, and sheets of less
    // than 30 degrees lie within the vertex's reach.
    if (kinds_[i] == Kind::Near && kindOf(qefs_[i + 1]) == Kind::Near) continue;
    if (fresh) creaseCell_.reset(&balls);
    fresh = false;
    placeAtCrease(i);
  }
}

Vector BlockVertices::plainPoint(std::size_t vertex) const {
  return solve(qefs_[vertex + 1].seenFrom(centers_[vertex]), kHalfCell);
}

void BlockVertices::placeAtCrease(std::size_t vertex) {
  const int cell = cells_[vertex];
  const Qef local = qefs_[vertex + 1].seenFrom(centers_[vertex]);
  const CreasePlacement placement =
      creaseCell_.place(cell >> 6, (cell >> 3) & 7, cell & 7, local.massPoint());
  if (placement.planes == 0) {
    kinds_[vertex] = kindOf(local);
    return;
  }
  points_[vertex] = placement.point;
  normals_[vertex] = placement.normal;
  if (placement.outOfCell) outOfCell_.push_back(static_cast<std::uint32_t>(vertex));
  if (placement.planes == 1) {
    kinds_[vertex] = Kind::Near;
    return;
  }
  kinds_[vertex] = Kind::Meeting;
  meetings_.push_back({static_cast<std::uint32_t>(vertex), placement.planes, placement.sheets});
}

}  // namespace tufa::uniform
