#pragma once

#include <tufa/contour.h>
#include <cmath>
#include <optional>

#include "grid/stored_grid.h"

namespace tufa::grid {

/// The isovalue and the side of it that is inside.
struct IsoChoice {
  double isovalue = 0;
  bool insideIsBelow = true;
};

/// Whether a value is inside. A value on the isovalue, NaN or an infinite one is outside.
[[nodiscard]] inline bool isInside(double value, const IsoChoice& iso) {
  if (!std::isfinite(value)) return false;
  return iso.insideIsBelow ? value < iso.isovalue : value > iso.isovalue;
}

/// Chooses what the caller left open. Isovalue: 0 for level sets, else half way between the least
/// and the greatest finite value, background included. Inside: below for level sets, above for fog
/// volumes, for other grids the side that the background is not on. Throws Error(InvalidArgument)
/// for an isovalue that is not finite, Error(UnsupportedGrid) for grids other than float and
/// double.
[[nodiscard]] IsoChoice chooseIsovalue(const StoredGrid& grid, std::optional<double> isovalue,
                                       Inside inside);

}  // namespace tufa::grid
