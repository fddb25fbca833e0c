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

/// Calls visit(place, set) for all values that are not finite, of voxels and tiles, active or not;
/// set(value) gives one another value.
template <class GridT, class Visit>
void forNonFinite(GridT& grid, const Visit& visit) {
  using Value = typename GridT::ValueType;
  using Leaf = typename GridT::TreeType::LeafNodeType;
  using Upper = typename GridT::TreeType::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  std::vector<Leaf*> leaves;
  grid.tree().getNodes(leaves);
  for (Leaf* leaf : leaves) {
    Value* const values = leaf->buffer().data();
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      if (std::isfinite(values[n])) continue;
      visit(leaf->offsetToGlobalCoord(n), [&](Value value) { values[n] = value; });
    }
  }
  const auto visitTiles = [&](auto& node) {
    for (auto tile = node.beginValueAll(); tile; ++tile) {
      if (std::isfinite(*tile)) continue;
      visit(tile.getCoord(), [&](Value value) { tile.setValue(value); });
    }
  };
  // Node by node: the iterator of a tree looks for its place in the root's table at each step.
  const auto visitNodes = [&]<class Node>() {
    std::vector<Node*> nodes;
    grid.tree().getNodes(nodes);
    for (Node* node : nodes) visitTiles(*node);
  };
  visitTiles(grid.tree().root());
  visitNodes.template operator()<Upper>();
  visitNodes.template operator()<Lower>();
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

void refuseNonFinite(const std::string& grid, std::size_t count, const Coord& first) {
  throw Error(ErrorCode::NonFiniteValues,
              "grid \"" + grid + "\" holds " + std::to_string(count) + " NaN or infinite " +
                  (count == 1 ? "value" : "values") + ", the first at index (" +
                  std::to_string(first[0]) + ", " + std::to_string(first[1]) + ", " +
                  std::to_string(first[2]) +
                  "); repair the grid or treat them as outside (NonFinite::Outside)");
}

void requireFiniteBackground(const std::string& grid, double background) {
  if (std::isfinite(background)) return;
  throw Error(ErrorCode::NonFiniteValues, "the background of grid \"" + grid +
                                              "\" is not a finite number; set a finite background");
}

template <class GridT>
std::size_t takeAsOutside(GridT& grid, const NonFiniteRule& rule) {
  requireFiniteBackground(grid.getName(), static_cast<double>(grid.background()));
  std::size_t count = 0;
  Coord first;
  forNonFinite(grid, [&](const openvdb::Coord& place, const auto&) {
    if (count++ == 0) first = fromVdb(place);
  });
  if (count == 0) return 0;
  if (rule.nonFinite == NonFinite::Refuse) refuseNonFinite(grid.getName(), count, first);
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
