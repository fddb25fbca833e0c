#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "grid/blocks.h"
#include "grid/field.h"
#include "uniform/case_table.h"

namespace tufa::uniform {

/// Index among CellTopology::blocks.
using SurfaceBlockIndex = std::uint32_t;
inline constexpr SurfaceBlockIndex kNoSurfaceBlock = ~SurfaceBlockIndex{0};

/// A surface cell with other than one vertex.
struct CellException {
  std::uint16_t cell;        ///< cellIndex()
  std::uint16_t count;       ///< vertices of this cell
  std::int32_t extraBefore;  ///< vertices beyond one a cell, of the cells before it in the block
};

/// What only few blocks need: how ambiguous faces are joined, which crossed edges are open, which
/// cells have other than one vertex.
struct SpecialBlock {
  /// For each axis, a bit for each face at the lower end of a cell whose inside corners are joined.
  std::array<grid::BlockBits, 3> joined;
  /// For each axis, a bit for each crossed edge that starts at a lattice point and is open because
  /// the data, or the part of the grid at hand, ends there.
  std::array<grid::BlockBits, 3> cut;
  std::vector<CellException> exceptions;  ///< sorted by cell
  std::int32_t extra = 0;                 ///< vertices beyond one a cell, of the whole block
  std::uint32_t faceFlips = 0;            ///< faces joined against the rule
};

/// A block that the surface passes.
struct SurfaceBlock {
  grid::BlockRef block = 0;
  std::int32_t special = -1;  ///< index among CellTopology::specials, or -1
  grid::Neighbours neighbours{};
  grid::BlockBits cells;                       ///< the surface cells
  std::array<std::uint16_t, 8> cellsBefore{};  ///< surface cells in the slabs before each
  std::uint32_t cellCount = 0;
  std::uint32_t quadCount = 0;
  std::uint64_t firstVertex = 0;
  std::uint64_t firstQuad = 0;
};

/// Which vertices and quads there will be, before any is placed: the uniform mesh but for its
/// geometry. Vertices are numbered by block, then cell, then component; quads by block, axis,
/// lattice point. So later stages know where to write, without locks or sorting. Cost: a block
/// keeps bits and a few counts; only special blocks, few on smooth surfaces, keep more.
struct CellTopology {
  std::vector<SurfaceBlock> blocks;
  std::vector<SpecialBlock> specials;
  std::vector<SurfaceBlockIndex> surfaceBlockOf;  ///< for each block of Blocks
  std::uint64_t vertexCount = 0;
  std::uint64_t quadCount = 0;
  std::size_t cellCount = 0;
  std::size_t openEdges = 0;
  std::size_t missingEdges = 0;  ///< of these, those in whose place blocks are missing

  /// The surface block at an offset of -1..1 blocks, or kNoSurfaceBlock.
  [[nodiscard]] SurfaceBlockIndex neighbour(const SurfaceBlock& from, int dx, int dy,
                                            int dz) const {
    const grid::BlockRef block = from.neighbours[grid::neighbourIndex(dx, dy, dz)];
    return block < 0 ? kNoSurfaceBlock : surfaceBlockOf[block];
  }
  /// Whether the data ends in the block or in one beside it.
  [[nodiscard]] bool isOpenAt(const SurfaceBlock& block) const;
  /// Number of the first vertex of a surface cell, counted inside its block.
  [[nodiscard]] std::uint32_t firstVertexInBlock(const SurfaceBlock& block, int cell) const;
  /// A bit for each ambiguous face of a cell whose inside corners are joined; the bits of other
  /// faces mean nothing.
  [[nodiscard]] FaceBits faceBits(const SurfaceBlock& block, int cell) const;
  /// A bit for each open edge of a cell.
  [[nodiscard]] unsigned openEdgesOf(const SurfaceBlock& block, int cell) const;
  /// The components of a cell of a block, with face bits and open edges taken into account.
  [[nodiscard]] Components componentsAt(const SurfaceBlock& block, int cell, CornerMask mask) const;
  /// Whether one component of the cell owns both arcs of its ambiguous face `face`.
  [[nodiscard]] bool ownsBothArcs(const SurfaceBlock& block, int cell, CornerMask mask,
                                  int face) const;
};

/// The corner mask of a cell.
[[nodiscard]] CornerMask cornerMask(const grid::CornerWords& corners, int cell);

/// Crossed edges along each axis that start at the lattice points of slab x.
[[nodiscard]] std::array<std::uint64_t, 3> crossedEdges(const grid::CornerWords& corners, int x);

/// Finds the surface cells, joins their crossings by the ambiguity rule, flips the faces that would
/// not be manifold, and numbers vertices and quads. The result is the same for any number of
/// threads.
///
/// Two cells that share an ambiguous face and both own its two arcs in one component would make an
/// edge of four quads; such a face is joined the other way (Wenger 2013). Why one sweep suffices: a
/// loop runs with the inside on its left on both arcs, so a flip joins the start of each arc with
/// the end of the other, which splits the loop in two, in both cells. A flip therefore never merges
/// components and never makes another face bad. It may make a second face of the same cell good, so
/// two faces of one cell must not be flipped at once: faces are taken in six classes (three axes,
/// even and odd), whose members share no cell.
[[nodiscard]] CellTopology buildCellTopology(const grid::Blocks& blocks,
                                             const grid::FieldScale& scale, Ambiguity rule,
                                             bool cap, base::Job& job);

/// The first part of that: the surface blocks with their cells, open edges and numbers of the
/// crossed edges, which are those of the quads. Each cell is counted as one vertex.
[[nodiscard]] CellTopology findSurfaceCells(const grid::Blocks& blocks,
                                            const grid::FieldScale& scale, bool cap,
                                            base::Job& job);

}  // namespace tufa::uniform
