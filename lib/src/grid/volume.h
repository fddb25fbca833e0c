#pragma once

#include <tufa/contour.h>

#include <optional>
#include <string>

#include "base/job.h"
#include "grid/affine.h"
#include "grid/blocks.h"
#include "grid/field.h"
#include "grid/stored_grid.h"
#include "grid/transform.h"

namespace tufa::grid {

/// A grid as later stages read it: what was chosen, its blocks, and how values and places are
/// scaled.
struct Volume {
  Blocks blocks;
  FieldScale scale;
  Transform transform;
  Affine affine;     ///< positions are counted from the lowest corner of all blocks of the grid
  double reach = 0;  ///< largest world coordinate of a corner of a block, of the whole grid
  /// Of a part: the blocks that it is made for. Others are there for what depends on them.
  std::optional<Slab> own;
};

/// Throws Error(UnsupportedGrid) unless the grid is a float or double grid with a linear transform
/// in the range of base::whyOutOfRange(), Error(LimitExceeded) if coordinates beside its own could
/// overflow.
void requireMeshable(const openvdb::GridBase& grid);

/// The name of a grid; empty if it has none.
[[nodiscard]] std::string nameOf(const openvdb::GridBase& grid);

/// Reads a grid that is meshable. Throws Error as contour() does.
[[nodiscard]] Volume openVolume(const StoredGrid& grid, const ContourOptions& options,
                                base::Job& job);

/// Reads the values of leaves that are not in memory yet.
void load(Volume& volume, base::Job& job);

/// The blocks of a slab alone, see Blocks, for the sake of those in `own`. Positions are counted
/// from the same point as in `whole`.
[[nodiscard]] Volume partOf(const Volume& whole, const Slab& slab, const Slab& own, base::Job& job);

}  // namespace tufa::grid
