#include "uniform/quads.h"

#include <algorithm>

#include "base/bits.h"
#include "base/huge_pages.h"
#include "grid/samples.h"
#include "uniform/diagonal.h"
#include "uniform/quad_places.h"

namespace tufa::uniform {

using grid::BlockBits;
using grid::CornerWords;
using grid::kBlockSize;

namespace {

// For each cell of a block, and of the layer of cells below it on each axis, its first vertex.
class VertexTable {
 public:
  VertexTable(const grid::Blocks& blocks, const CellTopology& topology)
      : blocks_(blocks), topology_(topology) {}

  void fill(const SurfaceBlock& block) {
    special_ = false;
    for (int corner = 0; corner < kCorners; ++corner) {
      const int dx = corner >> 2, dy = (corner >> 1) & 1, dz = corner & 1;
      const SurfaceBlockIndex index = topology_.neighbour(block, -dx, -dy, -dz);
      if (index == kNoSurfaceBlock) continue;
      fillFrom(topology_.blocks[index], dx, dy, dz);
    }
  }

  /// The vertex of the cell at (x, y, z), each -1..7, that owns the crossing of its edge `edge`.
  [[nodiscard]] VertexIndex at(int x, int y, int z, int edge) const {
    const int slot = slotOf(x, y, z);
    if (!special_) return first_[slot];
    return first_[slot] + static_cast<VertexIndex>(components_[slot].of(edge));
  }

 private:
  static constexpr int kSize = kBlockSize + 1;
  static int slotOf(int x, int y, int z) { return ((x + 1) * kSize + y + 1) * kSize + z + 1; }

  // Takes over the cells of `from`, which lies (dx, dy, dz) blocks below: all, or its last layer on
  // each of those axes.
  void fillFrom(const SurfaceBlock& from, int dx, int dy, int dz) {
    constexpr std::uint64_t kLastY = std::uint64_t{0xff} << 56;
    constexpr std::uint64_t kLastZ = 0x8080808080808080u;
    const std::uint64_t layer =
        (dy != 0 ? kLastY : ~std::uint64_t{0}) & (dz != 0 ? kLastZ : ~std::uint64_t{0});
    const bool special = from.special >= 0;
    const bool whole = dx == 0 && dy == 0 && dz == 0;
    CornerWords corners;
    if (special) corners = blocks_.cornerWords(from.neighbours);
    if (special && !special_) {
      special_ = true;
      components_.fill({});
    }
    auto next = static_cast<VertexIndex>(from.firstVertex);
    for (int x = dx != 0 ? kBlockSize - 1 : 0; x < kBlockSize; ++x) {
      base::forEachBit(from.cells.slabs[x] & layer, [&](int bit) {
        const int cell = x * 64 + bit;
        const int slot =
            slotOf(x - dx * kBlockSize, (bit >> 3) - dy * kBlockSize, (bit & 7) - dz * kBlockSize);
        if (special) {
          components_[slot] = topology_.componentsAt(from, cell, cornerMask(corners, cell));
        } else if (special_) {
          components_[slot] = {};
        }
        first_[slot] = whole && !special
                           ? next++
                           : static_cast<VertexIndex>(from.firstVertex +
                                                      topology_.firstVertexInBlock(from, cell));
      });
    }
  }

  const grid::Blocks& blocks_;
  const CellTopology& topology_;
  bool special_ = false;
  std::array<VertexIndex, kSize * kSize * kSize> first_{};
  std::array<Components, kSize * kSize * kSize> components_{};
};

template <int axis>
Quad quadAround(const VertexTable& table, const QuadPlace& place, bool mirrored) {
  constexpr int u = (axis + 1) % 3, v = (axis + 2) % 3;
  constexpr bool kSwapped = u > v;  // the edge numbers count the other axes in rising order
  Quad quad;
  for (int i = 0; i < 4; ++i) {
    const auto [du, dv] = kAround[i];
    std::array<int, 3> cell = place.start;
    cell[u] -= du;
    cell[v] -= dv;
    const int edge = axis * 4 + (kSwapped ? dv * 2 + du : du * 2 + dv);
    quad.vertices[i] = table.at(cell[0], cell[1], cell[2], edge);
  }
  if (place.upward == mirrored) std::swap(quad.vertices[1], quad.vertices[3]);
  return quad;
}

Quad quadAround(const VertexTable& table, const QuadPlace& place, bool mirrored) {
  switch (place.axis) {
    case 0:
      return quadAround<0>(table, place, mirrored);
    case 1:
      return quadAround<1>(table, place, mirrored);
    default:
      return quadAround<2>(table, place, mirrored);
  }
}

void turn(Quad& quad) {
  std::rotate(quad.vertices.begin(), quad.vertices.begin() + 1, quad.vertices.end());
}

// Where the surface crosses the lattice edge of a quad, by linear interpolation, and which way is
// out.
LatticeCrossing crossingOf(const SurfaceView& context, const SurfaceBlock& block,
                           const QuadPlace& place, grid::Accessor& accessor) {
  const grid::SampleReader samples(context.blocks, context.scale, block.block, block.neighbours,
                                   accessor);
  const auto [x, y, z] = place.start;
  const int axis = place.axis;
  const double a = samples.at(x, y, z);
  const double b = samples.at(x + (axis == 0), y + (axis == 1), z + (axis == 2));
  std::array<double, 3> at = {static_cast<double>(x), static_cast<double>(y),
                              static_cast<double>(z)};
  at[axis] += a == b ? 0.5 : a / (a - b);
  const Position point =
      context.affine.position(context.blocks.origin(block.block), at[0], at[1], at[2]);
  return {{point.x, point.y, point.z}, context.affine.axis(axis) * (place.upward ? 1.0 : -1.0)};
}

// Makes a quad near creases start at an end of its better diagonal.
void split(const SurfaceView& context, const SurfaceBlock& block, const QuadPlace& place,
           grid::Accessor& accessor, Mesh& mesh) {
  Quad& quad = mesh.quads[place.quad];
  const SplitChooser chooser(mesh, quad, context.affine.voxelSize());
  if (chooser.isSecondDiagonalBetterAtCrease(
          context.sheets, [&] { return crossingOf(context, block, place, accessor); })) {
    turn(quad);
  }
}

}  // namespace

void connectQuads(const SurfaceView& context, Mesh& mesh, base::Job& job) {
  const CellTopology& topology = context.topology;
  base::resizeLarge(mesh.quads, topology.quadCount, job);
  job.forRanges(topology.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
    VertexTable table(context.blocks, topology);
    const auto accessor = context.blocks.accessor();
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = topology.blocks[i];
      table.fill(block);
      forQuads(context, block, [&](const QuadPlace& place) {
        Quad quad = quadAround(table, place, context.affine.mirrored());
        if (!isNearCrease(context.sheets, quad)) {
          const SplitChooser chooser(mesh, quad, context.affine.voxelSize());
          if (chooser.isSecondDiagonalBetter(
                  [&] { return crossingOf(context, block, place, *accessor); })) {
            turn(quad);
          }
        }
        mesh.quads[place.quad] = quad;
      });
    }
  });
}

void splitAtCreases(const SurfaceView& context, Mesh& mesh, base::Job& job) {
  const CellTopology& topology = context.topology;
  const auto isMeant = [&](const Quad& quad) { return isNearCrease(context.sheets, quad); };
  job.forRanges(topology.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
    const auto accessor = context.blocks.accessor();
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = topology.blocks[i];
      const auto first = mesh.quads.begin() + static_cast<std::ptrdiff_t>(block.firstQuad);
      if (std::none_of(first, first + block.quadCount, isMeant)) continue;
      forQuads(context, block, [&](const QuadPlace& place) {
        if (isMeant(mesh.quads[place.quad])) split(context, block, place, *accessor, mesh);
      });
    }
  });
}

void splitAgain(const SurfaceView& context, const std::vector<std::uint32_t>& quads, Mesh& mesh,
                base::Job& job) {
  const std::vector<BlockRange> ranges = blocksOfQuads(context.topology, quads);
  job.forRanges(ranges.size(), 32, [&](std::size_t begin, std::size_t end) {
    const auto accessor = context.blocks.accessor();
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = context.topology.blocks[ranges[i].block];
      forQuadsAmong(context, quads, ranges[i], [&](const QuadPlace& place, std::size_t) {
        split(context, block, place, *accessor, mesh);
      });
    }
  });
}

std::vector<Position> quadCrossings(const SurfaceView& context,
                                    const std::vector<std::uint32_t>& quads, base::Job& job) {
  std::vector<Position> crossings(quads.size());
  const std::vector<BlockRange> ranges = blocksOfQuads(context.topology, quads);
  job.forRanges(ranges.size(), 32, [&](std::size_t begin, std::size_t end) {
    const auto accessor = context.blocks.accessor();
    for (std::size_t i = begin; i < end; ++i) {
      const SurfaceBlock& block = context.topology.blocks[ranges[i].block];
      forQuadsAmong(context, quads, ranges[i], [&](const QuadPlace& place, std::size_t slot) {
        const Vec3 point = crossingOf(context, block, place, *accessor).point;
        crossings[slot] = {point[0], point[1], point[2]};
      });
    }
  });
  return crossings;
}

}  // namespace tufa::uniform
