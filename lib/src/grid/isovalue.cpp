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
double middleValue(const GridT& grid, base::LeafSource* source) {
  using Upper = typename GridT::TreeType::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Leaf = typename Lower::ChildNodeType;
  double least = grid.background();
  double greatest = least;
  const auto add = [&](double value) {
    if (!std::isfinite(value)) return;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  };
  const auto addValues = [&](const auto& node) {
    for (auto value = node.cbeginValueOn(); value; ++value) add(*value);
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
  std::vector<const Leaf*> leaves;
  grid.tree().getNodes(leaves);
  LeafValues<Leaf> valuesOf(source);
  for (std::size_t n = 0; n < leaves.size(); ++n) {
    const auto* values = valuesOf.of(*leaves[n], n);
    for (auto voxel = leaves[n]->getValueMask().beginOn(); voxel; ++voxel) add(values[voxel.pos()]);
  }
  return std::midpoint(least, greatest);
}

template <class GridT>
IsoChoice choose(const GridT& grid, base::LeafSource* source, std::optional<double> isovalue,
                 Inside inside) {
  const openvdb::GridClass gridClass = grid.getGridClass();
  IsoChoice choice;
  if (isovalue) {
    choice.isovalue = *isovalue;
  } else if (gridClass != openvdb::GRID_LEVEL_SET) {
    choice.isovalue = middleValue(grid, source);
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

IsoChoice chooseIsovalue(const StoredGrid& stored, std::optional<double> isovalue, Inside inside) {
  const openvdb::GridBase& grid = stored.grid;
  if (isovalue && !std::isfinite(*isovalue)) {
    throw Error(ErrorCode::InvalidArgument, "the isovalue is not a finite number");
  }
  if (grid.isType<openvdb::FloatGrid>()) {
    return choose(static_cast<const openvdb::FloatGrid&>(grid), stored.leaves, isovalue, inside);
  }
  if (grid.isType<openvdb::DoubleGrid>()) {
    return choose(static_cast<const openvdb::DoubleGrid&>(grid), stored.leaves, isovalue, inside);
  }
  throw Error(ErrorCode::UnsupportedGrid,
              "grid \"" + grid.getName() + "\" holds values of type " + grid.valueType() +
                  "; only float and double grids of OpenVDB's standard tree have an isosurface");
}

}  // namespace tufa::grid
