#include "grid/isovalue.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <vector>

namespace tufa::grid {
namespace {

// Half way between the least and the greatest finite value; the background counts as one.
template <class GridT>
double middleValue(const GridT& grid) {
  using Upper = typename GridT::TreeType::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  double least = grid.background();
  double greatest = least;
  const auto addValues = [&](const auto& node) {
    for (auto value = node.cbeginValueOn(); value; ++value) {
      const double v = *value;
      if (!std::isfinite(v)) continue;
      least = std::min(least, v);
      greatest = std::max(greatest, v);
    }
  };
  const auto addNodes = [&]<class Node>() {
    std::vector<const Node*> nodes;
    grid.tree().getNodes(nodes);
    for (const Node* node : nodes) addValues(*node);
  };
  // Node by node: the iterator of a tree looks for its place in the root's table at each step.
  addValues(grid.tree().root());
  addNodes.template operator()<Upper>();
  addNodes.template operator()<Lower>();
  addNodes.template operator()<typename Lower::ChildNodeType>();
  return std::midpoint(least, greatest);
}

template <class GridT>
IsoChoice choose(const GridT& grid, std::optional<double> isovalue, Inside inside) {
  const openvdb::GridClass gridClass = grid.getGridClass();
  IsoChoice choice;
  if (isovalue) {
    choice.isovalue = *isovalue;
  } else if (gridClass != openvdb::GRID_LEVEL_SET) {
    choice.isovalue = middleValue(grid);
  }
  switch (inside) {
    case Inside::Below:
      choice.insideIsBelow = true;
      break;
    case Inside::Above:
      choice.insideIsBelow = false;
      break;
    case Inside::Auto:
      choice.insideIsBelow =
          gridClass == openvdb::GRID_LEVEL_SET ||
          (gridClass != openvdb::GRID_FOG_VOLUME && grid.background() >= choice.isovalue);
      break;
  }
  return choice;
}

}  // namespace

IsoChoice chooseIsovalue(const openvdb::GridBase& grid, std::optional<double> isovalue,
                         Inside inside) {
  if (isovalue && !std::isfinite(*isovalue)) {
    throw Error(ErrorCode::InvalidArgument, "the isovalue is not a finite number");
  }
  if (grid.isType<openvdb::FloatGrid>()) {
    return choose(static_cast<const openvdb::FloatGrid&>(grid), isovalue, inside);
  }
  if (grid.isType<openvdb::DoubleGrid>()) {
    return choose(static_cast<const openvdb::DoubleGrid&>(grid), isovalue, inside);
  }
  throw Error(ErrorCode::UnsupportedGrid,
              "grid \"" + grid.getName() + "\" holds values of type " + grid.valueType() +
                  "; only float and double grids of OpenVDB's standard tree have an isosurface");
}

}  // namespace tufa::grid
