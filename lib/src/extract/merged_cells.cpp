#include "extract/merged_cells.h"

#include <algorithm>
#include <array>
#include <limits>

#include "extract/cell_walk.h"
#include "extract/fill_loop.h"
#include "grid/block_bits.h"

namespace tufa::extraction {

using grid::kBlockSize;
using uniform::SurfaceBlock;

namespace {

using Place = std::array<int, 3>;

// Of each two cells along each axis of a block the level of their leaf: it has 2^level cells along
// an edge. Cells in none are leaves of their own.
struct BlockLevels {
  std::array<std::uint8_t, 64> levels{};

  static int slotOf(const Place& at) { return (at[0] >> 1) * 16 + (at[1] >> 1) * 4 + (at[2] >> 1); }
  // Where the leaf of a cell begins.
  [[nodiscard]] Place leafOf(const Place& cell) const {
    const int level = levels[slotOf(cell)];
    return {cell[0] >> level << level, cell[1] >> level << level, cell[2] >> level << level};
  }
};

// The surface cells of one block, by their places.
struct BlockCells {
  struct Cell {
    std::uint64_t index = 0;  ///< among all surface cells
    CaseCode code = 0;
  };
  std::array<std::int16_t, grid::kBlockCells> numbers{};  ///< -1 for none
  std::vector<Cell> cells;

  [[nodiscard]] const Cell* at(const Place& place) const {
    const std::int16_t number = numbers[grid::cellIndex(place[0], place[1], place[2])];
    return number < 0 ? nullptr : &cells[static_cast<std::size_t>(number)];
  }
};

// The corners of a cell that are the lower ends of its edges along each axis, by bits.
constexpr std::array<unsigned, 3> kLowerCorners = {0x0f, 0x33, 0x55};

template <class Body>
void forPlaces(const Place& first, int size, const Body& body) {
  for (int x = first[0]; x < first[0] + size; ++x) {
    for (int y = first[1]; y < first[1] + size; ++y) {
      for (int z = first[2]; z < first[2] + size; ++z) body(Place{x, y, z});
    }
  }
}

// The lower end of an edge of a cell.
Place startOf(const Place& cell, int edge) {
  const int lower = uniform::edgeCorners(edge)[0];
  return {cell[0] + (lower >> 2), cell[1] + ((lower >> 1) & 1), cell[2] + (lower & 1)};
}

// A part of the boundary of the surface in a leaf, with where it starts.
struct Arc {
  LoopCorner from;
  VertexIndex to = 0;
  bool stays = true;  ///< its start
  bool visited = false;
};

class CellMerger {
 public:
  CellMerger(const grid::Volume& volume, CubeCells& cells,
             const std::vector<CellFeatures>& features, const Mesh& crossings,
             const MergeRule& rule, base::Job& job)
      : volume_(volume),
        cells_(cells),
        topology_(cells.topology),
        features_(features),
        crossings_(crossings),
        rule_(rule),
        job_(job) {}

  std::vector<BlockTriangles> run() {
    const std::size_t count = topology_.blocks.size();
    levels_.resize(count);
    forBlocks([&](std::size_t i, const BlockCells& cells, BlockTable& table) {
      if (topology_.isOpenAt(topology_.blocks[i])) return;
      const grid::CornerWords corners = volume_.blocks.cornerWords(topology_.blocks[i].neighbours);
      findLeaves({0, 0, 0}, kMostLevel, {cells, table.table(), corners}, levels_[i]);
    });
    std::vector<BlockTriangles> triangles(count);
    forBlocks([&](std::size_t i, const BlockCells& cells, BlockTable& table) {
      for (int slot = 0; slot < 64; ++slot) {
        const Place at = {slot >> 4 << 1, ((slot >> 2) & 3) << 1, (slot & 3) << 1};
        if (levels_[i].levels[slot] == 0 || levels_[i].leafOf(at) != at) continue;
        emitLeaf(i, at, 1 << levels_[i].levels[slot], cells, table.table(), triangles[i]);
      }
    });
    return triangles;
  }

 private:
  static constexpr int kMostLevel = 3;

  // Calls body(index, cells, table) for each surface block.
  template <class Body>
  void forBlocks(const Body& body) {
    job_.forRanges(topology_.blocks.size(), 16, [&](std::size_t begin, std::size_t end) {
      BlockTable table(cells_);
      BlockCells cells;
      for (std::size_t i = begin; i < end; ++i) {
        cells.numbers.fill(-1);
        cells.cells.clear();
        walkBlock(cells_, i, table, [&](const WalkedCell& cell) {
          cells.numbers[grid::cellIndex(cell.at[0], cell.at[1], cell.at[2])] =
              static_cast<std::int16_t>(cells.cells.size());
          cells.cells.push_back({cell.place.cell, cell.code});
        });
        body(i, cells, table);
      }
    });
  }

  // What is asked of a block to find its leaves.
  struct Block {
    const BlockCells& cells;
    const CubeTable& table;
    const grid::CornerWords& corners;
  };

  void findLeaves(const Place& at, int level, const Block& block, BlockLevels& levels) const {
    const int size = 1 << level;
    if (isLeaf(at, size, block)) {
      forPlaces(at, size, [&](const Place& cell) {
        levels.levels[BlockLevels::slotOf(cell)] = static_cast<std::uint8_t>(level);
      });
      return;
    }
    for (int part = 0; level > 1 && part < 8; ++part) {
      const int half = size / 2;
      findLeaves(
          {at[0] + (part >> 2) * half, at[1] + ((part >> 1) & 1) * half, at[2] + (part & 1) * half},
          level - 1, block, levels);
    }
  }

  // Calls body(vertex) for the crossings of the cells of a leaf, several times for most.
  template <class Body>
  static void forCrossings(const Place& at, int size, const Block& block, const Body& body) {
    forPlaces(at, size, [&](const Place& place) {
      const BlockCells::Cell* const cell = block.cells.at(place);
      if (cell == nullptr) return;
      const CubeCase& chosen = caseOf(cell->code);
      const int tablePlace = CubeTable::placeOf(place[0], place[1], place[2]);
      for (int edge = 0; edge < kEdges; ++edge) {
        if (chosen.next[edge] >= 0) body(block.table[tablePlace + kEdgeOffsets[edge]]);
      }
    });
  }

  [[nodiscard]] bool isLeaf(const Place& at, int size, const Block& block) const {
    bool smooth = true, any = false;
    // A bit for each axis: whether a lattice edge along it leads out of the inside, or into it.
    unsigned out = 0, in = 0;
    forPlaces(at, size, [&](const Place& place) {
      const BlockCells::Cell* const cell = block.cells.at(place);
      if (cell == nullptr) return;
      any = true;
      smooth = smooth && features_[cell->index].parts == 0;
      const unsigned mask =
          uniform::cornerMask(block.corners, grid::cellIndex(place[0], place[1], place[2]));
      for (int axis = 0; axis < 3; ++axis) {
        const unsigned lower = mask & kLowerCorners[axis];
        const unsigned upper = mask >> (4 >> axis) & kLowerCorners[axis];
        out |= static_cast<unsigned>((lower & ~upper) != 0) << axis;
        in |= static_cast<unsigned>((upper & ~lower) != 0) << axis;
      }
    });
    return any && smooth && (out & in) == 0 && isFlat(at, size, block);
  }

  // Whether two parallel planes as far apart as the tolerance have all crossings between them, and
  // no normal differs much from theirs.
  [[nodiscard]] bool isFlat(const Place& at, int size, const Block& block) const {
    Vec3 normal(0);
    forCrossings(at, size, block,
                 [&](VertexIndex vertex) { normal += Vec3(crossings_.normals[vertex]); });
    if (!normal.normalize()) return false;
    double least = std::numeric_limits<double>::infinity(), most = -least, cosine = 1;
    forCrossings(at, size, block, [&](VertexIndex vertex) {
      const double along = normal.dot(Vec3(crossings_.positions[vertex]));
      least = std::min(least, along);
      most = std::max(most, along);
      cosine = std::min(cosine, normal.dot(Vec3(crossings_.normals[vertex])));
    });
    return most - least <= rule_.tolerance * volume_.affine.voxelSize() &&
           cosine >= rule_.leastCosine;
  }

  // Fills the loops on a leaf and takes the cases of its cells away.
  void emitLeaf(std::size_t index, const Place& at, int size, const BlockCells& cells,
                const CubeTable& table, BlockTriangles& to) {
    std::vector<Arc> arcs;
    forPlaces(at, size, [&](const Place& place) {
      const BlockCells::Cell* const cell = cells.at(place);
      if (cell == nullptr) return;
      addArcs(index, place, caseOf(cell->code), at, size, table, arcs);
      cells_.codes[cell->index] = 0;
    });
    std::sort(arcs.begin(), arcs.end(),
              [](const Arc& a, const Arc& b) { return a.from.vertex < b.from.vertex; });
    std::vector<LoopCorner> loop;
    const std::size_t first = to.triangles.size();
    for (Arc& start : arcs) {
      loop.clear();
      for (Arc* arc = &start; !arc->visited; arc = &arcFrom(arcs, arc->to)) {
        arc->visited = true;
        if (arc->stays) loop.push_back(arc->from);
      }
      if (!loop.empty()) fillLoop(loop, crossings_, to);
    }
    if (!volume_.affine.mirrored()) return;
    for (std::size_t t = first; t < to.triangles.size(); ++t) {
      std::swap(to.triangles[t].vertices[1], to.triangles[t].vertices[2]);
    }
  }

  static Arc& arcFrom(std::vector<Arc>& arcs, VertexIndex vertex) {
    return *std::lower_bound(
        arcs.begin(), arcs.end(), vertex,
        [](const Arc& arc, VertexIndex sought) { return arc.from.vertex < sought; });
  }

  // Adds the arcs of a cell that are in faces of its leaf.
  void addArcs(std::size_t index, const Place& cell, const CubeCase& chosen, const Place& leaf,
               int size, const CubeTable& table, std::vector<Arc>& arcs) const {
    const int place = CubeTable::placeOf(cell[0], cell[1], cell[2]);
    for (int edge = 0; edge < kEdges; ++edge) {
      const int next = chosen.next[edge];
      if (next < 0) continue;
      const int face = kFaceOf[edge][next], axis = face / 2;
      const int last = (face & 1) != 0 ? leaf[axis] + size - 1 : leaf[axis];
      if (cell[axis] != last) continue;
      Arc arc;
      arc.from.vertex = table[place + kEdgeOffsets[edge]];
      arc.to = table[place + kEdgeOffsets[next]];
      const Place start = startOf(cell, edge);
      for (int other = 0; other < 3; ++other) {
        if (other == edge / 4) continue;
        const int away = start[other] - leaf[other];
        const int on = away == 0 ? 1 : away == size ? 2 : 0;
        arc.from.faces = static_cast<std::uint8_t>(arc.from.faces | on << (2 * other));
      }
      arc.stays = leavesAround(index, start, edge / 4) > 2;
      arcs.push_back(arc);
    }
  }

  // How many leaves there are around a crossed lattice edge. All cells around it are surface cells.
  [[nodiscard]] int leavesAround(std::size_t index, const Place& start, int axis) const {
    const auto [u, v] = uniform::otherAxes(axis);
    std::array<std::size_t, 4> leaves{};
    int count = 0;
    for (int step = 0; step < 4; ++step) {
      Place at = start;
      at[u] -= step & 1;
      at[v] -= step >> 1;
      const std::size_t leaf = leafOf(index, at);
      if (std::find(leaves.begin(), leaves.begin() + count, leaf) == leaves.begin() + count) {
        leaves[count++] = leaf;
      }
    }
    return count;
  }

  // A number for the leaf of a cell up to one step beyond a block.
  [[nodiscard]] std::size_t leafOf(std::size_t index, const Place& at) const {
    const std::size_t owner =
        topology_.neighbour(topology_.blocks[index], at[0] >> 3, at[1] >> 3, at[2] >> 3);
    const Place first = levels_[owner].leafOf({at[0] & 7, at[1] & 7, at[2] & 7});
    return owner * grid::kBlockCells +
           static_cast<std::size_t>(grid::cellIndex(first[0], first[1], first[2]));
  }

  const grid::Volume& volume_;
  CubeCells& cells_;
  const uniform::CellTopology& topology_;
  const std::vector<CellFeatures>& features_;
  const Mesh& crossings_;
  MergeRule rule_;
  base::Job& job_;
  std::vector<BlockLevels> levels_;  ///< of each surface block
};

}  // namespace

std::vector<BlockTriangles> mergeCells(const grid::Volume& volume, CubeCells& cells,
                                       const std::vector<CellFeatures>& features,
                                       const Mesh& crossings, const MergeRule& rule,
                                       base::Job& job) {
  return CellMerger(volume, cells, features, crossings, rule, job).run();
}

}  // namespace tufa::extraction
