#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "base/job.h"
#include "extract/cell_features.h"
#include "extract/cube_cells.h"
#include "grid/volume.h"
#include "uniform/crease_cell.h"

namespace tufa::extraction {

/// The vertex on a crease or corner that a loop of a cell has, and, where they are known, the
/// sheets that meet there; the point is in voxels from the middle of the cell.
struct LoopFeature {
  Feature vertex;
  uniform::CreasePlacement sheets;
};

/// All loops of a volume's cells that have such a vertex.
struct SharpLoops {
  std::vector<CellFeatures> cells;               ///< of each surface cell, numbers in its block
  std::vector<std::vector<LoopFeature>> blocks;  ///< of each surface block

  /// The feature of a loop of a cell; null for none.
  [[nodiscard]] const LoopFeature* of(const CubeCells::Place& place, int loop) const {
    const CellFeatures& cell = cells[place.cell];
    return cell.has(loop) ? &blocks[place.block][cell.of(loop)] : nullptr;
  }
};

/// The cosine of an angle in degrees.
[[nodiscard]] inline double cosineOf(double degrees) {
  return std::cos(degrees * std::numbers::pi / 180);
}

/// Finds the loops whose normals differ by more than this cosine tells, and the best point for the
/// tangent planes of each: in distance fields where the sheets around the cell meet, see
/// SheetsOfCell, or else by the QEF of the crossings. `mesh` holds the crossings.
///
/// A vertex leaves its cell only in distance fields, by a voxel at most, and only where its planes
/// do not meet in it, as where a crease runs through cells without sign changes. There, too, a loop
/// whose own normals differ little has one where the sheets of the loops beyond its arcs meet in
/// its cell: a crease clips it. Which directions the planes leave free is told by the eigenvalues
/// (uniform::solve).
[[nodiscard]] SharpLoops findSharpLoops(const grid::Volume& volume, const CubeCells& cells,
                                        const Mesh& mesh, double leastCosine, base::Job& job);

}  // namespace tufa::extraction
