// Finds the surface cells of all blocks and decides how their components go on through faces.

#include <atomic>
#include <memory>

#include "base/bits.h"
#include "base/huge_pages.h"
#include "grid/samples.h"
#include "uniform/ambiguity.h"
#include "uniform/cell_topology.h"

namespace tufa::uniform {

using grid::BlockBits;
using grid::CornerWords;
using grid::kBlockSize;

namespace {

// Builds a CellTopology step by step; each step is one parallel pass over blocks.
class CellTopologyBuilder {
 public:
  CellTopologyBuilder(const grid::Blocks& blocks, const grid::FieldScale& scale, base::Job& job)
      : blocks_(blocks), scale_(scale), job_(job) {}

  CellTopology findCells(bool cap) {
    findSurfaceBlocks();
    chooseSpecialBlocks(scale_.narrowBand && !cap, blocks_.isPart());
    number();
    return std::move(topology_);
  }

  CellTopology build(Ambiguity rule, bool cap) {
    findSurfaceBlocks();
    chooseSpecialBlocks(scale_.narrowBand && !cap, blocks_.isPart());
    joinFaces(rule);
    flipFaces();
    countVertices();
    number();
    return std::move(topology_);
  }

 private:
  using Accessor = grid::Accessor;
  using Cuts = std::array<BlockBits, 3>;  ///< the open edges of a block along each axis

  void findSurfaceBlocks() {
    std::vector<BlockBits> cells;
    base::resizeLarge(cells, blocks_.count(), job_);
    std::vector<std::uint8_t> found(blocks_.count());
    job_.forRanges(blocks_.count(), 64, [&](std::size_t begin, std::size_t end) {
      const auto accessor = blocks_.accessor();
      for (std::size_t i = begin; i < end; ++i) {
        const auto block = static_cast<grid::BlockRef>(i);
        cells[i] = surfaceCells(blocks_.cornerWords(blocks_.upperNeighbours(block, *accessor)));
        found[i] = cells[i].any() ? 1 : 0;
      }
    });
    topology_.surfaceBlockOf.assign(blocks_.count(), kNoSurfaceBlock);
    base::reserveLarge(topology_.blocks, static_cast<std::size_t>(std::count(
                                             found.begin(), found.end(), std::uint8_t{1})));
    for (std::size_t i = 0; i < blocks_.count(); ++i) {
      job_.pollCancelled(i);
      if (found[i] == 0) continue;
      topology_.surfaceBlockOf[i] = static_cast<SurfaceBlockIndex>(topology_.blocks.size());
      topology_.blocks.emplace_back();
      topology_.blocks.back().block = static_cast<grid::BlockRef>(i);
    }
    forBlocks([&](SurfaceBlock& block, std::size_t, Accessor& accessor) {
      block.neighbours = blocks_.neighbours(block.block, accessor);
      block.cells = cells[block.block];
      for (int x = 0; x < kBlockSize; ++x) {
        block.cellsBefore[x] = static_cast<std::uint16_t>(block.cellCount);
        block.cellCount += static_cast<std::uint32_t>(base::countBits(block.cells.slabs[x]));
      }
    });
  }

  static BlockBits surfaceCells(const CornerWords& corners) {
    BlockBits cells;
    std::array<std::uint64_t, kBlockSize + 1> any{}, all{};
    for (int x = 0; x <= kBlockSize; ++x) {
      const auto& w = corners.words[x];
      any[x] = w[0] | w[1] | w[2] | w[3];
      all[x] = w[0] & w[1] & w[2] & w[3];
    }
    for (int x = 0; x < kBlockSize; ++x) {
      cells.slabs[x] = (any[x] | any[x + 1]) & ~(all[x] & all[x + 1]);
    }
    return cells;
  }

  // A block is special if a cell of it may have several components or touches an open edge.
  void chooseSpecialBlocks(bool dataEnds, bool blocksEnd) {
    const bool cut = dataEnds || blocksEnd;
    const std::size_t count = topology_.blocks.size();
    std::vector<std::unique_ptr<Cuts>> cuts(cut ? count : 0);  // most blocks have none
    std::vector<std::uint8_t> special(count, 0);
    std::vector<std::uint8_t> hasCut(cut ? count : 0, 0);
    std::atomic<std::size_t> missing{0};
    forBlocks([&](SurfaceBlock& block, std::size_t i, Accessor& accessor) {
      const CornerWords corners = blocks_.cornerWords(block.neighbours);
      block.quadCount = countCrossedEdges(corners);
      special[i] = mayHaveSeveralComponents(corners) ? 1 : 0;
      Cuts own{};
      bool any = dataEnds && findOpenEdges(block, corners, accessor, own);
      const std::size_t ofData = any ? countAll(own) : 0;
      if (blocksEnd && cutAtMissing(block, corners, own)) {
        any = true;
        missing += countAll(own) - ofData;
      }
      if (!any) return;
      hasCut[i] = 1;
      cuts[i] = std::make_unique<Cuts>(own);
    });
    topology_.missingEdges = missing;
    for (std::size_t i = 0; i < count; ++i) {
      job_.pollCancelled(i);
      SurfaceBlock& block = topology_.blocks[i];
      for (int corner = 0; cut && corner < kCorners; ++corner) {
        const SurfaceBlockIndex above =
            topology_.neighbour(block, corner >> 2, (corner >> 1) & 1, corner & 1);
        if (above != kNoSurfaceBlock && hasCut[above] != 0) special[i] = 1;
      }
      if (special[i] == 0) continue;
      block.special = static_cast<std::int32_t>(topology_.specials.size());
      topology_.specials.emplace_back();
      if (!cut || cuts[i] == nullptr) continue;
      topology_.specials.back().cut = *cuts[i];
      for (const BlockBits& bits : *cuts[i]) {
        topology_.openEdges += bits.count();
        block.quadCount -= static_cast<std::uint32_t>(bits.count());
      }
    }
  }

  static std::size_t countAll(const Cuts& cuts) {
    return cuts[0].count() + cuts[1].count() + cuts[2].count();
  }

  // A face alternates if its diagonal corners are equal and its neighbouring ones are not.
  static std::uint64_t alternates(std::uint64_t a, std::uint64_t b, std::uint64_t c,
                                  std::uint64_t d) {
    return ~(a ^ d) & ~(b ^ c) & (a ^ b);
  }

  // Cells of which two opposite corners differ from the other six. They have two components, though
  // none of their faces is ambiguous; no other cell without an ambiguous face has.
  static std::uint64_t oppositeCornersAlone(const std::array<std::uint64_t, 4>& lower,
                                            const std::array<std::uint64_t, 4>& upper) {
    std::uint64_t found = 0;
    for (int i = 0; i < 4; ++i) {
      std::uint64_t alone = ~(lower[i] ^ upper[3 - i]);
      for (int other = 0; other < 4; ++other) {
        if (other != i) alone &= lower[i] ^ lower[other];
        if (other != 3 - i) alone &= lower[i] ^ upper[other];
      }
      found |= alone;
    }
    return found;
  }

  // Whether a cell of the block may have more than one component.
  static bool mayHaveSeveralComponents(const CornerWords& corners) {
    std::uint64_t found = 0;
    for (int x = 0; x <= kBlockSize; ++x) {
      const auto& w = corners.words[x];
      found |= alternates(w[0], w[1], w[2], w[3]);
      if (x == kBlockSize) break;
      const auto& n = corners.words[x + 1];
      found |= alternates(w[0], w[1], n[0], n[1]) | alternates(w[2], w[3], n[2], n[3]);
      found |= alternates(w[0], w[2], n[0], n[2]) | alternates(w[1], w[3], n[1], n[3]);
      found |= oppositeCornersAlone(w, n);
    }
    return found != 0;
  }

  // Finds the crossed edges that have a cell in a missing block; they are open.
  static bool cutAtMissing(const SurfaceBlock& block, const CornerWords& corners,
                           std::array<BlockBits, 3>& cuts) {
    constexpr std::uint64_t kFirstY = 0xff, kFirstZ = 0x0101010101010101u;
    bool any = false;
    for (int corner = 1; corner < kCorners; ++corner) {
      const int dx = corner >> 2, dy = (corner >> 1) & 1, dz = corner & 1;
      if (block.neighbours[grid::neighbourIndex(-dx, -dy, -dz)] != grid::kMissingBlock) continue;
      const std::uint64_t layer =
          (dy != 0 ? kFirstY : ~std::uint64_t{0}) & (dz != 0 ? kFirstZ : ~std::uint64_t{0});
      for (int x = 0; x < (dx != 0 ? 1 : kBlockSize); ++x) {
        const auto crossed = crossedEdges(corners, x);
        for (int axis = 0; axis < 3; ++axis) {
          // The cells around an edge lie beside it on the other axes.
          if ((axis == 0 ? dx : axis == 1 ? dy : dz) != 0) continue;
          cuts[axis].slabs[x] |= crossed[axis] & layer;
          any |= (crossed[axis] & layer) != 0;
        }
      }
    }
    return any;
  }

  // Finds sign changes between an active and an inactive sample that a distance cannot make in one
  // step; they are open.
  bool findOpenEdges(const SurfaceBlock& block, const CornerWords& corners, Accessor& accessor,
                     std::array<BlockBits, 3>& cuts) const {
    const grid::SampleReader samples(blocks_, scale_, block.block, block.neighbours, accessor);
    bool any = false;
    for (int x = 0; x < kBlockSize; ++x) {
      const auto crossed = crossedEdges(corners, x);
      const auto active = samples.activeEdges(x);
      for (int axis = 0; axis < 3; ++axis) {
        base::forEachBit(crossed[axis] & ~active[axis], [&](int bit) {
          const int y = bit >> 3, z = bit & 7;
          const double a = samples.at(x, y, z);
          const double b = samples.at(x + (axis == 0), y + (axis == 1), z + (axis == 2));
          if (std::abs(a - b) <= grid::kLongestStep * scale_.axisLength[axis]) return;
          cuts[axis].slabs[x] |= std::uint64_t{1} << bit;
          any = true;
        });
      }
    }
    return any;
  }

  void joinFaces(Ambiguity rule) {
    if (rule == Ambiguity::Separate) return;
    forSpecialBlocks([&](SurfaceBlock& block, SpecialBlock& special, Accessor& accessor) {
      const CornerWords corners = blocks_.cornerWords(block.neighbours);
      const grid::SampleReader samples(blocks_, scale_, block.block, block.neighbours, accessor);
      forAmbiguousFaces(block, corners, [&](int axis, int cell) {
        std::array<double, 4> values{};
        for (int i = 0; i < 4; ++i) {
          const int corner = kFaceCorners[axis * 2][i];
          values[i] =
              samples.at((cell >> 6) + (corner >> 2), ((cell >> 3) & 7) + ((corner >> 1) & 1),
                         (cell & 7) + (corner & 1));
        }
        if (joinsInside(rule, values)) special.joined[axis].set(cell);
      });
    });
  }

  // Calls body(axis, cell) for each ambiguous face at the lower end of a cell of the block.
  template <class Body>
  static void forAmbiguousFaces(const SurfaceBlock& block, const CornerWords& corners,
                                const Body& body) {
    for (int x = 0; x < kBlockSize; ++x) {
      const auto& w = corners.words[x];
      const auto& n = corners.words[x + 1];
      const std::array<std::uint64_t, 3> faces = {alternates(w[0], w[1], w[2], w[3]),
                                                  alternates(w[0], w[1], n[0], n[1]),
                                                  alternates(w[0], w[2], n[0], n[2])};
      for (int axis = 0; axis < 3; ++axis) {
        base::forEachBit(faces[axis] & block.cells.slabs[x],
                         [&](int bit) { body(axis, x * 64 + bit); });
      }
    }
  }

  // All bad faces of a class are found before any is flipped, see buildCellTopology().
  void flipFaces() {
    std::vector<BlockBits> flips(topology_.specials.size());
    for (int axis = 0; axis < 3; ++axis) {
      for (int parity = 0; parity < 2; ++parity) {
        forSpecialBlocks([&](SurfaceBlock& block, SpecialBlock&, Accessor&) {
          flips[block.special] = badFaces(block, axis, parity);
        });
        for (std::size_t i = 0; i < flips.size(); ++i) {
          for (int x = 0; x < kBlockSize; ++x) {
            topology_.specials[i].joined[axis].slabs[x] ^= flips[i].slabs[x];
          }
          topology_.specials[i].faceFlips += static_cast<std::uint32_t>(flips[i].count());
        }
      }
    }
  }

  // Faces of a class at the lower ends of cells of the block whose arcs have one owner in both
  // cells. The block below exists: were it missing, all edges of the face would be open.
  BlockBits badFaces(const SurfaceBlock& block, int axis, int parity) const {
    BlockBits bad;
    const CornerWords corners = blocks_.cornerWords(block.neighbours);
    const int shift = axis == 0 ? 6 : axis == 1 ? 3 : 0;
    forAmbiguousFaces(block, corners, [&](int faceAxis, int cell) {
      const int along = (cell >> shift) & 7;
      if (faceAxis != axis || (along & 1) != parity) return;
      if (!topology_.ownsBothArcs(block, cell, cornerMask(corners, cell), axis * 2)) return;
      const SurfaceBlock* below = &block;
      int lowerCell = cell - (1 << shift);
      CornerWords lowerCorners = corners;
      if (along == 0) {
        lowerCell = cell + (7 << shift);
        below = &topology_.blocks[topology_.neighbour(block, axis == 0 ? -1 : 0, axis == 1 ? -1 : 0,
                                                      axis == 2 ? -1 : 0)];
        lowerCorners = blocks_.cornerWords(below->neighbours);
      }
      if (topology_.ownsBothArcs(*below, lowerCell, cornerMask(lowerCorners, lowerCell),
                                 axis * 2 + 1)) {
        bad.set(cell);
      }
    });
    return bad;
  }

  void countVertices() {
    forSpecialBlocks([&](SurfaceBlock& block, SpecialBlock& special, Accessor&) {
      const CornerWords corners = blocks_.cornerWords(block.neighbours);
      for (int x = 0; x < kBlockSize; ++x) {
        base::forEachBit(block.cells.slabs[x], [&](int bit) {
          const int cell = x * 64 + bit;
          const int count = topology_.componentsAt(block, cell, cornerMask(corners, cell)).count();
          if (count == 1) return;
          special.exceptions.push_back(
              {static_cast<std::uint16_t>(cell), static_cast<std::uint16_t>(count), special.extra});
          special.extra += count - 1;
        });
      }
    });
  }

  static std::uint32_t countCrossedEdges(const CornerWords& corners) {
    int count = 0;
    for (int x = 0; x < kBlockSize; ++x) {
      for (const std::uint64_t crossed : crossedEdges(corners, x))
        count += base::countBits(crossed);
    }
    return static_cast<std::uint32_t>(count);
  }

  void number() {
    for (SurfaceBlock& block : topology_.blocks) {
      block.firstVertex = topology_.vertexCount;
      block.firstQuad = topology_.quadCount;
      const std::int32_t extra = block.special < 0 ? 0 : topology_.specials[block.special].extra;
      topology_.vertexCount += block.cellCount + static_cast<std::uint64_t>(std::int64_t{extra});
      topology_.quadCount += block.quadCount;
      topology_.cellCount += block.cellCount;
    }
  }

  template <class Body>
  void forBlocks(const Body& body) {
    job_.forRanges(topology_.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
      const auto accessor = blocks_.accessor();
      for (std::size_t i = begin; i < end; ++i) body(topology_.blocks[i], i, *accessor);
    });
  }

  template <class Body>
  void forSpecialBlocks(const Body& body) {
    if (topology_.specials.empty()) return;
    forBlocks([&](SurfaceBlock& block, std::size_t, Accessor& accessor) {
      if (block.special >= 0) body(block, topology_.specials[block.special], accessor);
    });
  }

  const grid::Blocks& blocks_;
  const grid::FieldScale& scale_;
  base::Job& job_;
  CellTopology topology_;
};

}  // namespace

CellTopology buildCellTopology(const grid::Blocks& blocks, const grid::FieldScale& scale,
                               Ambiguity rule, bool cap, base::Job& job) {
  return CellTopologyBuilder(blocks, scale, job).build(rule, cap);
}

CellTopology findSurfaceCells(const grid::Blocks& blocks, const grid::FieldScale& scale, bool cap,
                              base::Job& job) {
  return CellTopologyBuilder(blocks, scale, job).findCells(cap);
}

}  // namespace tufa::uniform
