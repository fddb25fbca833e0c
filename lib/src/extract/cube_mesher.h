#pragma once

#include <tufa/contour.h>

#include <array>
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

/// Samples at the corners of a cell, negative inside.
using CornerValues = std::array<float, kCorners>;

/// How a method chooses the case of a cell: by its corner mask, or, for the masks that `asks`
/// names, by its values too.
struct CubeRule {
  std::array<CaseCode, 256> codes{};
  std::array<bool, 256> asks{};
  CaseCode (*decide)(CornerMask mask, const CornerValues& values) = nullptr;
};

/// Meshes the cells of a volume by their cases: a vertex on each crossed lattice edge, placed as
/// the crossings of dual contouring are, and for some cases one inside the cell. Positions are
/// counted from the volume's affine.origin(). Sets what `report` says of cells.
[[nodiscard]] Mesh meshCubes(const grid::Volume& volume, const CubeRule& rule,
                             const ContourOptions& options, ContourReport& report, base::Job& job);

}  // namespace tufa::extraction
