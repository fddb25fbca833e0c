#pragma once

#include <tufa/contour.h>

#include <array>
#include <optional>
#include <vector>

#include "base/job.h"
#include "extract/block_edges.h"
#include "extract/cube_cases.h"
#include "grid/volume.h"

namespace tufa::extraction {

/// The edges of the lattice: one along each axis.
struct CubeLattice {
  static constexpr int kKinds = 3;
  static constexpr std::array<int, kKinds> kReach = {3, 5, 6};  ///< the other two axes
};
using CubeEdges = BlockEdges<CubeLattice::kKinds>;
using CubeTable = EdgeTable<CubeLattice>;

/// What to add to the place of a cell, see EdgeTable, for each of its edges.
inline constexpr auto kEdgeOffsets = [] {
  std::array<int, kEdges> offsets{};
  for (int edge = 0; edge < kEdges; ++edge) {
    const int lower = uniform::edgeCorners(edge)[0];
    offsets[edge] = CubeTable::offsetOf(edge / 4, lower >> 2, (lower >> 1) & 1, lower & 1);
  }
  return offsets;
}();

/// Samples at the corners of a cell, negative inside.
using CornerValues = std::array<float, kCorners>;

/// How a method chooses the case of a cell: by its corner mask, or, for the masks that `asks`
/// names, by its values too.
struct CubeRule {
  std::array<CaseCode, 256> codes{};
  std::array<bool, 256> asks{};
  CaseCode (*decide)(CornerMask mask, const CornerValues& values) = nullptr;
};

/// The surface cells of a volume with their cases, and the numbers of the vertices on edges.
struct CubeCells {
  /// Of the cases of one block.
  struct Counts {
    std::uint32_t triangles = 0;
    std::uint32_t centres = 0;
  };

  uniform::CellTopology topology;
  std::vector<CubeEdges> edges;  ///< of each surface block
  std::vector<Counts> counts;    ///< of each surface block
  std::vector<CaseCode> codes;   ///< of each surface cell, 0 for one with open edges
  std::uint64_t edgeCount = 0;

  /// A surface cell: its block among the surface blocks, and itself among all surface cells.
  struct Place {
    std::size_t block = 0;
    std::uint64_t cell = 0;
  };

  /// The surface cell at this many lattice steps from the origin of a block; nothing if no surface
  /// passes the block there. The cell must be one that the surface passes.
  [[nodiscard]] std::optional<Place> find(const uniform::SurfaceBlock& from,
                                          const std::array<int, 3>& at) const {
    const auto index = topology.neighbour(from, at[0] >> 3, at[1] >> 3, at[2] >> 3);
    if (index == uniform::kNoSurfaceBlock) return std::nullopt;
    const uniform::SurfaceBlock& owner = topology.blocks[index];
    const int local = grid::cellIndex(at[0] & 7, at[1] & 7, at[2] & 7);
    return Place{index, owner.firstVertex + topology.firstVertexInBlock(owner, local)};
  }

  /// Calls body(x, bit, code) for each surface cell of a block.
  template <class Body>
  void forCells(const uniform::SurfaceBlock& block, const Body& body) const {
    const CaseCode* code = codes.data() + block.firstVertex;
    for (int x = 0; x < grid::kBlockSize; ++x) {
      base::forEachBit(block.cells.slabs[x], [&](int bit) { body(x, bit, *code++); });
    }
  }
};

/// Finds the surface cells and chooses their cases. Two stages of the job: "cells" and "cases".
[[nodiscard]] CubeCells chooseCases(const grid::Volume& volume, const CubeRule& rule, bool cap,
                                    base::Job& job);

}  // namespace tufa::extraction
