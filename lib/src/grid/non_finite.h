#pragma once

#include <tufa/contour.h>
#include <tufa/openvdb_fwd.h>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "base/index_box.h"

namespace tufa::grid {

/// Throws Error(NonFiniteValues): so many values of a grid of that name are not finite, and where
/// the first one is.
[[noreturn]] void refuseNonFinite(const std::string& grid, std::size_t count, const Coord& first);

/// Throws Error(NonFiniteValues) for a background that is not finite, of a grid of that name.
void requireFiniteBackground(const std::string& grid, double background);

/// How NaN and infinite values are taken, and what is outside.
struct NonFiniteRule {
  NonFinite nonFinite = NonFinite::Refuse;
  std::optional<double> isovalue;
  Inside inside = Inside::Auto;
};

/// Gives NaN and infinite values of a grid one that is outside: its background or, where that is
/// inside, the value as far from the isovalue on the other side. Returns how many there were.
/// Throws as refuseNonFinite() if they are refused, and as requireFiniteBackground(). GridT: float
/// and double grids.
template <class GridT>
std::size_t takeAsOutside(GridT& grid, const NonFiniteRule& rule);

/// A copy of a float or double grid in which no value is NaN or infinite, or null if none was.
[[nodiscard]] std::shared_ptr<openvdb::GridBase> finiteCopy(const openvdb::GridBase& grid,
                                                            const NonFiniteRule& rule);

}  // namespace tufa::grid
