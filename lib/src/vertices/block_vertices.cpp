#include "vertices/block_vertices.h"

#include "base/bits.h"

namespace tufa::vertices {

using blocks::CornerWords;
using blocks::kBlockSize;
using components::SurfaceBlock;
using components::Topology;

namespace {

// Vertices keep this distance from the faces of their cell, so that no two of different cells meet.
constexpr float kHalfCell = 0.499F;
// A mean normal shorter than this is of more than one side (two of equal weight, 30 degrees apart).
constexpr float kOneSide = 0.966F;

using Kind = creases::VertexSides::Kind;

// Whether the planes of a QEF seem to belong to one smooth side.
Kind kindOf(const qef::Qef& qef) {
  const float squared = qef::dot(qef.normals, qef.normals);
  return squared < kOneSide * kOneSide * qef.count * qef.count ? Kind::Unknown : Kind::Near;
}

}  // namespace

template <class TreeT>
void BlockVertices::place(const blocks::Blocks<TreeT>& blocks, const Topology& topology,
                          const SurfaceBlock& block,
                          typename blocks::Blocks<TreeT>::Accessor& accessor) {
  const CornerWords corners = blocks.cornerWords(block.neighbours);
  samples_.gather(blocks, scale_, block.block, block.neighbours, accessor);
  numberVertices(topology, block, corners);
  addEdges<0>(corners);
  addEdges<1>(corners);
  addEdges<2>(corners);
  solveAll();
}

void BlockVertices::numberVertices(const Topology& topology, const SurfaceBlock& block,
                                   const CornerWords& corners) {
  special_ = block.special >= 0;
  cells_.clear();
  for (int x = 0; x < kBlockSize; ++x) {
    base::forEachBit(block.cells.slabs[x], [&](int bit) {
      const int cell = x * 64 + bit;
      firstVertexOf_[cell] = static_cast<std::uint16_t>(cells_.size());
      int count = 1;
      if (special_) {
        componentsOf_[cell] =
            topology.componentsAt(block, cell, components::cornerMask(corners, cell));
        cutEdgesOf_[cell] = static_cast<std::uint16_t>(topology.cutEdgesOf(block, cell));
        count = componentsOf_[cell].count();
      }
      cells_.insert(cells_.end(), count, static_cast<std::uint16_t>(cell));
    });
  }
  qefs_.assign(cells_.size(), {});
  kinds_.assign(cells_.size(), Kind::Smooth);
  meetings_.clear();
}

// Every crossed edge of the block's cells along one axis, those on its upper faces included.
template <int axis>
void BlockVertices::addEdges(const CornerWords& corners) {
  constexpr std::uint64_t kLastY = std::uint64_t{0xff} << 56;
  constexpr std::uint64_t kLastZ = 0x8080808080808080u;
  for (int x = 0; x < kBlockSize + (axis == 0 ? 0 : 1); ++x) {
    const auto& w = corners.words[x];
    // Word i is the lattice points (y + i / 2, z + i % 2).
    std::array<std::uint64_t, 4> crossed{};
    for (int i = 0; i < 4; ++i) {
      if (axis == 0) crossed[i] = w[i] ^ corners.words[x + 1][i];
      if (axis == 1 && i < 2) crossed[i] = w[i] ^ w[i + 2];
      if (axis == 2 && i % 2 == 0) crossed[i] = w[i] ^ w[i + 1];
    }
    base::forEachBit(crossed[0], [&](int bit) { addCrossing<axis>(x, bit >> 3, bit & 7); });
    if (axis != 2) {
      base::forEachBit(crossed[1] & kLastZ,
                       [&](int bit) { addCrossing<axis>(x, bit >> 3, 8); });
    }
    if (axis != 1) {
      base::forEachBit(crossed[2] & kLastY,
                       [&](int bit) { addCrossing<axis>(x, 8, bit & 7); });
    }
    if (axis == 0) {
      base::forEachBit(crossed[3] & kLastY & kLastZ,
                       [&](int) { addCrossing<axis>(x, 8, 8); });
    }
  }
}

template <int axis>
void BlockVertices::addCrossing(int x, int y, int z) {
  const crossings::Crossing crossing =
      finder_.at<axis>(blocks::BlockSamples::index(x, y, z));
  qef::Vector point = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  point[axis] += crossing.along;
  const qef::Qef plane(point, crossing.normal);
  constexpr auto kOther = components::otherAxes(axis);
  const std::array<int, 3> start = {x, y, z};
  for (int side = 0; side < 4; ++side) {
    // The edge is number `side` of this cell: at the cell's upper end of the first other axis if bit
    // 1 is set, of the second if bit 0 is.
    std::array<int, 3> at = start;
    at[kOther[0]] -= side >> 1;
    at[kOther[1]] -= side & 1;
    if (((at[0] | at[1] | at[2]) & ~7) != 0) continue;
    const int cell = blocks::cellIndex(at[0], at[1], at[2]);
    int vertex = firstVertexOf_[cell];
    if (special_) {
      const int edge = axis * 4 + side;
      if (((cutEdgesOf_[cell] >> edge) & 1) != 0) continue;
      vertex += componentsOf_[cell].of(edge);
    }
    qefs_[vertex] += plane;
    if (crossing.crease) kinds_[vertex] = Kind::Near;
  }
}

void BlockVertices::solveAll() {
  points_.resize(qefs_.size());
  normals_.resize(qefs_.size());
  bool fresh = true;
  for (std::size_t i = 0; i < qefs_.size(); ++i) {
    const int cell = cells_[i];
    const int x = cell >> 6, y = (cell >> 3) & 7, z = cell & 7;
    const qef::Qef local = qefs_[i].seenFrom({static_cast<float>(x) + 0.5F,
                                              static_cast<float>(y) + 0.5F,
                                              static_cast<float>(z) + 0.5F});
    points_[i] = qef::solve(local, kHalfCell);
    normals_[i] = local.normals;
    if (kinds_[i] == Kind::Smooth) continue;
    if (fresh) creaseCell_.reset();
    fresh = false;
    const creases::CreasePlacement placement = creaseCell_.place(x, y, z, local.massPoint());
    if (placement.planes == 0) {
      kinds_[i] = kindOf(local);
      continue;
    }
    points_[i] = placement.point;
    normals_[i] = placement.normal;
    if (placement.planes == 1) continue;
    kinds_[i] = Kind::Meeting;
    meetings_.push_back({static_cast<std::uint32_t>(i), placement.planes, placement.sides});
  }
}

template void BlockVertices::place(const blocks::Blocks<openvdb::FloatTree>&, const Topology&,
                                   const SurfaceBlock&,
                                   blocks::Blocks<openvdb::FloatTree>::Accessor&);
template void BlockVertices::place(const blocks::Blocks<openvdb::DoubleTree>&, const Topology&,
                                   const SurfaceBlock&,
                                   blocks::Blocks<openvdb::DoubleTree>::Accessor&);

}  // namespace tufa::vertices
