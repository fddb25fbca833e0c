#include "grid/non_finite.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <cmath>
#include <string>
#include <vector>

#include "grid/isovalue.h"
#include "grid/vdb_coord.h"

namespace tufa::grid {
namespace {

/// Calls visit(value, place) for all values that are not finite, of voxels and tiles, active or
/// not; visit may change them.
template <class GridT, class Visit>
void forNonFinite(GridT& grid, const Visit& visit) {
  using Leaf = typename GridT::TreeType::LeafNodeType;
  for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf) {
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      if (std::isfinite(leaf->getValue(n))) continue;
      visit(leaf->offsetToGlobalCoord(n), [&](auto value) { leaf->setValueOnly(n, value); });
    }
  }
  auto tile = grid.tree().beginValueAll();
  for (tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1); tile; ++tile) {
    if (std::isfinite(*tile)) continue;
    visit(tile.getCoord(), [&](auto value) { tile.setValue(value); });
  }
}

double outsideValue(const openvdb::GridBase& grid, double background, const NonFiniteRule& rule) {
  const IsoChoice iso = chooseIsovalue(grid, rule.isovalue, rule.inside);
  return isInside(background, iso) ? 2 * iso.isovalue - background : background;
}

template <class GridT>
std::shared_ptr<openvdb::GridBase> finiteCopyOf(const GridT& grid, const NonFiniteRule& rule) {
  auto copy = grid.deepCopy();
  return takeAsOutside(*copy, rule) > 0 ? copy : nullptr;
}

}  // namespace

void refuseNonFinite(std::size_t count, const Coord& first) {
  throw Error(ErrorCode::NonFiniteValues,
              "the grid holds " + std::to_string(count) + " NaN or infinite " +
                  (count == 1 ? "value" : "values") + ", the first at index (" +
                  std::to_string(first[0]) + ", " + std::to_string(first[1]) + ", " +
                  std::to_string(first[2]) +
                  "); repair the grid or treat them as outside (--nan outside)");
}

template <class GridT>
std::size_t takeAsOutside(GridT& grid, const NonFiniteRule& rule) {
  std::size_t count = 0;
  Coord first;
  forNonFinite(grid, [&](const openvdb::Coord& place, const auto&) {
    if (count++ == 0) first = fromVdb(place);
  });
  if (count == 0) return 0;
  if (rule.nonFinite == NonFinite::Refuse) refuseNonFinite(count, first);
  using Value = typename GridT::ValueType;
  const auto outside =
      static_cast<Value>(outsideValue(grid, static_cast<double>(grid.background()), rule));
  forNonFinite(grid, [&](const openvdb::Coord&, const auto& set) { set(outside); });
  return count;
}

std::shared_ptr<openvdb::GridBase> finiteCopy(const openvdb::GridBase& grid,
                                              const NonFiniteRule& rule) {
  std::shared_ptr<openvdb::GridBase> copy;
  grid.apply<openvdb::RealGridTypes>([&](const auto& typed) { copy = finiteCopyOf(typed, rule); });
  return copy;
}

template std::size_t takeAsOutside(openvdb::FloatGrid&, const NonFiniteRule&);
template std::size_t takeAsOutside(openvdb::DoubleGrid&, const NonFiniteRule&);

}  // namespace tufa::grid
