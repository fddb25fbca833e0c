#include "distance/reference.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "base/bits.h"
#include "base/flat_triangle.h"
#include "base/huge_pages.h"

namespace tufa::distance {

using grid::kBlockSize;
using uniform::SurfaceBlock;

namespace {

// A vertex faces away if its normal has a cosine less than this with the direction asked for; on
// the corner of a cube the normals of vertex and face have 0.58. Vertices on creases always count.
constexpr double kFacing = 0.2;
// Cells on each side of a point that are searched if the nearest vertex is not near enough.
constexpr int kAround = 2;
constexpr int kSide = 2 * kAround + 1;

// A cache of the blocks around a point, by the lowest bits of their coordinates: cells within a few
// voxels lie in at most two blocks per axis, so each is looked up once. Farther searches replace
// entries.
class BlockCache {
 public:
  explicit BlockCache(const octree::ClusterForest& forest) : forest_(forest) {}

  [[nodiscard]] std::uint32_t at(const Coord& cell) {
    const Coord wanted = cell >> 3;
    const int slot = (wanted[0] & 1) * 4 + (wanted[1] & 1) * 2 + (wanted[2] & 1);
    Entry& entry = entries_[slot];
    if (!entry.filled || entry.cell != wanted)
      entry = {true, wanted, forest_.find(octree::ClusterForest::kBlockLevel, wanted)};
    return entry.block;
  }

 private:
  struct Entry {
    bool filled = false;
    Coord cell;
    std::uint32_t block = octree::kNone;
  };
  const octree::ClusterForest& forest_;
  std::array<Entry, 8> entries_;
};

// Offsets to the cells around one, nearest first.
using Offsets = std::array<std::array<int, 3>, kSide * kSide * kSide>;

Offsets makeOffsets() {
  Offsets offsets;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    offsets[i] = {i / (kSide * kSide) - kAround, i / kSide % kSide - kAround, i % kSide - kAround};
  }
  const auto squared = [](const std::array<int, 3>& o) {
    return o[0] * o[0] + o[1] * o[1] + o[2] * o[2];
  };
  std::stable_sort(offsets.begin(), offsets.end(),
                   [&](const auto& a, const auto& b) { return squared(a) < squared(b); });
  return offsets;
}

const Offsets& nearestFirst() {
  static const Offsets offsets = makeOffsets();
  return offsets;
}

}  // namespace

// A quad's index is the first of its block plus the number of crossed edges before its own, by
// axis, slab and bit: the order in which the quads were made.
UniformReference::UniformReference(const uniform::SurfaceView& base,
                                   const octree::ClusterForest& forest, base::Job& job)
    : base_(base), forest_(forest) {
  base::resizeLarge(edges_, base.topology.blocks.size(), job);
  job.forRanges(edges_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = base_.topology.blocks[i];
      const grid::CornerWords corners = base_.blocks.cornerWords(block.neighbours);
      std::uint16_t count = 0;
      for (int axis = 0; axis < 3; ++axis) {
        for (int x = 0; x < kBlockSize; ++x) {
          std::uint64_t crossed = uniform::crossedEdges(corners, x)[axis];
          if (block.special >= 0) {
            crossed &= ~base_.topology.specials[block.special].cut[axis].slabs[x];
          }
          edges_[i].crossed[axis][x] = crossed;
          edges_[i].before[axis][x] = count;
          count = static_cast<std::uint16_t>(count + base::countBits(crossed));
        }
      }
    }
  });
}

// The nearest vertex of a cell that does not face away from `facing`, if it is nearer than `near`.
void UniformReference::searchCell(std::uint32_t block, int cell, const Vec3& point,
                                  const Vec3& facing, Near& near) const {
  const SurfaceBlock& surface = base_.topology.blocks[block];
  const std::uint32_t first = base_.topology.firstVertexInBlock(surface, cell);
  std::uint32_t count = 1;
  if (surface.special >= 0) {
    // The next cell's first vertex would tell the count, but the last cell of the block has no next
    // one.
    for (const uniform::CellException& exception :
         base_.topology.specials[surface.special].exceptions) {
      if (exception.cell == cell) count = exception.count;
    }
  }
  for (std::uint32_t i = first; i < first + count; ++i) {
    const std::size_t vertex = surface.firstVertex + i;
    const double squared = (Vec3(base_.mesh.positions[vertex]) - point).squaredLength();
    if (squared >= near.squared) continue;
    const Normal& n = base_.mesh.normals[vertex];
    const bool sharp = base_.sheets.isSharp(static_cast<VertexIndex>(vertex));
    if (!sharp && Vec3(n).dot(facing) < kFacing) continue;
    near = {block, cell, squared};
  }
}

UniformReference::Near UniformReference::vertexInCell(const Vec3& point, const Vec3& facing) const {
  const Vec3 at = base_.affine.latticePoint({point[0], point[1], point[2]}, base_.affine.origin());
  const Coord cell = base_.affine.origin() + floorCoord(at);
  const std::uint32_t block = forest_.find(octree::ClusterForest::kBlockLevel, cell >> 3);
  Near near;
  if (block == octree::kNone) return near;
  const int local = grid::cellIndex(cell[0] & 7, cell[1] & 7, cell[2] & 7);
  if (base_.topology.blocks[block].cells.get(local)) searchCell(block, local, point, facing, near);
  return near;
}

UniformReference::Near UniformReference::nearestVertex(const Vec3& point, const Vec3& facing,
                                                       int reach) const {
  const Vec3 at = base_.affine.latticePoint({point[0], point[1], point[2]}, base_.affine.origin());
  const Coord middle = base_.affine.origin() + floorCoord(at);
  BlockCache blocks(forest_);
  Near near;
  // The 27 cells around the point. If they hold no vertex, shells of cells outward, and one more
  // shell after the first with a vertex: it may hold a nearer one.
  for (int radius = 1; radius <= reach; ++radius) {
    const bool last = near.block != octree::kNone;
    for (int x = -radius; x <= radius; ++x) {
      for (int y = -radius; y <= radius; ++y) {
        const bool inside = std::max(std::abs(x), std::abs(y)) < radius && radius > 1;
        for (int z = -radius; z <= radius; z += inside ? 2 * radius : 1) {
          const Coord cell = middle.offsetBy(x, y, z);
          const std::uint32_t block = blocks.at(cell);
          if (block == octree::kNone) continue;
          const int local = grid::cellIndex(cell[0] & 7, cell[1] & 7, cell[2] & 7);
          if (base_.topology.blocks[block].cells.get(local)) {
            searchCell(block, local, point, facing, near);
          }
        }
      }
    }
    if (last || (radius == 1 && near.block != octree::kNone)) break;
  }
  return near;
}

double UniformReference::distanceToQuad(const Vec3& point, std::size_t quad) const {
  const auto& v = base_.mesh.quads[quad].vertices;
  const Vec3 p[4] = {Vec3(base_.mesh.positions[v[0]]), Vec3(base_.mesh.positions[v[1]]),
                     Vec3(base_.mesh.positions[v[2]]), Vec3(base_.mesh.positions[v[3]])};
  double best = std::numeric_limits<double>::infinity();
  for (int i = 1; i <= 2; ++i) {
    best = std::min(best, base::squaredDistanceTo(point, p[0], p[i], p[i + 1]));
  }
  return std::sqrt(best);
}

template <class IsKnown>
double UniformReference::distanceAtCell(std::uint32_t cellBlock, int cellNumber, const Vec3& point,
                                        const IsKnown& isKnown) const {
  double best = std::numeric_limits<double>::infinity();
  const std::array<int, 3> cell = {cellNumber >> 6, (cellNumber >> 3) & 7, cellNumber & 7};
  for (int edge = 0; edge < uniform::kEdges; ++edge) {
    const int axis = edge / 4, corner = uniform::edgeCorners(edge)[0];
    const int x = cell[0] + (corner >> 2), y = cell[1] + ((corner >> 1) & 1),
              z = cell[2] + (corner & 1);
    std::uint32_t block = cellBlock;
    if (((x | y | z) & 8) != 0) {
      block = base_.topology.neighbour(base_.topology.blocks[block], x >> 3, y >> 3, z >> 3);
      if (block == uniform::kNoSurfaceBlock) continue;
    }
    const int bit = (y & 7) * 8 + (z & 7);
    const std::uint64_t crossed = edges_[block].crossed[axis][x & 7];
    if (((crossed >> bit) & 1) == 0 || isKnown(corner, axis)) continue;
    const std::size_t index =
        base_.topology.blocks[block].firstQuad + edges_[block].before[axis][x & 7] +
        static_cast<std::size_t>(base::countBits(crossed & base::bitsBelow(bit)));
    best = std::min(best, distanceToQuad(point, index));
  }
  return best;
}

double UniformReference::distance(const Vec3& point, const Vec3& facing, int reach,
                                  double enough) const {
  const auto distanceAt = [&](const Near& near) {
    return distanceAtCell(near.block, near.cell, point, [](int, int) { return false; });
  };
  // Mostly the surface passes the cell of the point itself: one block lookup.
  Near near = vertexInCell(point, facing);
  if (near.block != octree::kNone) {
    const double own = distanceAt(near);
    if (own <= enough) return own;
  }
  near = nearestVertex(point, facing, reach);
  if (near.block == octree::kNone) return std::numeric_limits<double>::infinity();
  const double best = distanceAt(near);
  // Beside a crease the nearest polygon need not be at the nearest vertex.
  return best <= enough ? best : std::min(best, distanceAround(point, facing, enough));
}

// The distance to the polygons around all vertices within kAround cells that do not face away.
// Cells are taken nearest first, and an edge that several of them share is measured once.
double UniformReference::distanceAround(const Vec3& point, const Vec3& facing,
                                        double enough) const {
  double best = std::numeric_limits<double>::infinity();
  const Vec3 at = base_.affine.latticePoint({point[0], point[1], point[2]}, base_.affine.origin());
  const Coord middle = base_.affine.origin() + floorCoord(at);
  BlockCache blocks(forest_);
  // Each polygon lies around four cells: remembers the edges that were measured, by start point and
  // axis.
  std::bitset<std::size_t{3} * (kSide + 1) * (kSide + 1) * (kSide + 1)> known;
  for (const std::array<int, 3>& offset : nearestFirst()) {
    if (best <= enough) break;
    const Coord cell = middle.offsetBy(offset[0], offset[1], offset[2]);
    const std::uint32_t block = blocks.at(cell);
    if (block == octree::kNone) continue;
    const int local = grid::cellIndex(cell[0] & 7, cell[1] & 7, cell[2] & 7);
    if (!base_.topology.blocks[block].cells.get(local)) continue;
    Near facingIt;
    searchCell(block, local, point, facing, facingIt);
    if (facingIt.block == octree::kNone) continue;
    best = std::min(best, distanceAtCell(block, local, point, [&](int corner, int axis) {
                      std::size_t place = static_cast<std::size_t>(axis);
                      for (int i = 0; i < 3; ++i) {
                        const int along = offset[i] + kAround + ((corner >> (2 - i)) & 1);
                        place = place * (kSide + 1) + static_cast<std::size_t>(along);
                      }
                      const bool was = known[place];
                      known[place] = true;
                      return was;
                    }));
  }
  return best;
}

}  // namespace tufa::distance
