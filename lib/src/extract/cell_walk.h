#pragma once

#include <array>

#include "base/job.h"
#include "extract/cell_features.h"
#include "extract/cube_cells.h"

namespace tufa::extraction {

/// The vertices on the edges of one block after the other, put together where a cell asks for them.
class BlockTable {
 public:
  explicit BlockTable(const CubeCells& cells) : cells_(cells) {}

  void moveTo(const uniform::SurfaceBlock& block) {
    block_ = &block;
    filled_ = false;
  }
  [[nodiscard]] const CubeTable& table() {
    if (!filled_) table_.fill(cells_.topology, *block_, cells_.edges);
    filled_ = true;
    return table_;
  }

 private:
  const CubeCells& cells_;
  const uniform::SurfaceBlock* block_ = nullptr;
  CubeTable table_;
  bool filled_ = false;
};

/// A surface cell as a walk over the cells of its block comes to it.
struct WalkedCell {
  const uniform::SurfaceBlock& block;
  std::array<int, 3> at;  ///< in the block
  CubeCells::Place place;
  BlockTable& tables;
  CaseCode code;

  [[nodiscard]] const CubeCase& cubeCase() const { return caseOf(code); }
  [[nodiscard]] CornerMask mask() const { return maskOf(code); }
  [[nodiscard]] const CubeTable& table() const { return tables.table(); }
  [[nodiscard]] int tablePlace() const { return CubeTable::placeOf(at[0], at[1], at[2]); }
  /// Of a crossed edge.
  [[nodiscard]] VertexIndex vertexAt(int edge) const {
    return table()[tablePlace() + kEdgeOffsets[edge]];
  }
  [[nodiscard]] Coord corner(const grid::Blocks& blocks) const {
    return blocks.origin(block.block).offsetBy(at[0], at[1], at[2]);
  }
};

/// Calls body(cell) for the surface cells of a block, in their order.
template <class Body>
void walkBlock(const CubeCells& cells, std::size_t index, BlockTable& tables, const Body& body) {
  const uniform::SurfaceBlock& block = cells.topology.blocks[index];
  tables.moveTo(block);
  std::uint64_t cell = block.firstVertex;
  cells.forCells(block, [&](int x, int bit, CaseCode code) {
    body(WalkedCell{block, {x, bit >> 3, bit & 7}, {index, cell++}, tables, code});
  });
}

/// Calls body(cell) for all surface cells; those of one block in their order, by one thread.
template <class Body>
void walkCells(const CubeCells& cells, base::Job& job, const Body& body) {
  job.forRanges(cells.topology.blocks.size(), 32, [&](std::size_t begin, std::size_t end) {
    BlockTable tables(cells);
    for (std::size_t i = begin; i < end; ++i) walkBlock(cells, i, tables, body);
  });
}

/// The loop of the next cell that shares the arc from a crossing of a loop to the next one.
struct LoopBeyond {
  CubeCells::Place place;
  int face = 0;   ///< between the two cells, as the first one numbers it
  int loop = -1;  ///< -1 for none
};

[[nodiscard]] inline LoopBeyond loopBeyond(const CubeCells& cells, const WalkedCell& cell,
                                           int edge) {
  LoopBeyond beyond;
  beyond.face = kFaceOf[edge][cell.cubeCase().next[edge]];
  const int axis = beyond.face / 2;
  std::array<int, 3> at = cell.at;
  at[axis] += (beyond.face & 1) != 0 ? 1 : -1;
  const auto place = cells.find(cell.block, at);
  if (!place) return beyond;
  beyond.place = *place;
  const CubeCase& next = caseOf(cells.codes[place->cell]);
  const int arrives = kBeyond[edge][axis];
  // It has no triangles where it has open edges.
  if (next.next[arrives] >= 0) beyond.loop = next.loopOf[arrives];
  return beyond;
}

}  // namespace tufa::extraction
