#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/memory.h>
#include <algorithm>
#include <cmath>

#include "base/lattice_range.h"
#include "base/parallel.h"
#include "io/grid/grid_traits.h"
#include "io/grid/vdb_reader.h"

namespace tufa {
namespace {

std::string describeTransform(const openvdb::math::Transform& transform) {
  using namespace openvdb::math;
  const openvdb::Name type = transform.mapType();
  if (type == NonlinearFrustumMap::mapType()) return "frustum";
  if (type == UniformScaleMap::mapType()) return "uniform scale";
  if (type == UniformScaleTranslateMap::mapType()) return "uniform scale and translation";
  if (type == ScaleMap::mapType()) return "scale";
  if (type == ScaleTranslateMap::mapType()) return "scale and translation";
  if (type == TranslationMap::mapType()) return "translation";
  if (type == UnitaryMap::mapType()) return "rotation";
  if (type == AffineMap::mapType()) return "affine";
  return type;
}

std::string describeClass(openvdb::GridClass gridClass) {
  switch (gridClass) {
    case openvdb::GRID_LEVEL_SET:
      return "level set";
    case openvdb::GRID_FOG_VOLUME:
      return "fog volume";
    case openvdb::GRID_STAGGERED:
      return "staggered vector field";
    default:
      return "unknown";
  }
}

bool isToldElsewhere(const std::string& name) {
  return name == openvdb::GridBase::META_GRID_NAME || name == openvdb::GridBase::META_GRID_CLASS ||
         name.starts_with("file_");
}

/// Adds `count` voxels of one value.
void addValue(GridInfo& info, double value, std::size_t count) {
  if (!std::isfinite(value)) {
    info.nonFiniteValues += count;
    return;
  }
  info.minValue = std::min(value, info.minValue.value_or(value));
  info.maxValue = std::max(value, info.maxValue.value_or(value));
}

/// Adds what lies in a node in place of children.
template <class Node>
void addTiles(const Node& node, GridInfo& info) {
  for (auto tile = node.cbeginValueOn(); tile; ++tile) {
    addValue(info, static_cast<double>(*tile), Node::ChildNodeType::NUM_VOXELS);
  }
}

template <class GridT>
void addValues(const openvdb::GridBase& base, GridInfo& info) {
  if (!base.isType<GridT>()) return;
  const auto& tree = static_cast<const GridT&>(base).tree();
  info.background = static_cast<double>(tree.background());
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    for (auto value = leaf->cbeginValueOn(); value; ++value) {
      addValue(info, static_cast<double>(*value), 1);
    }
  }
  using Upper = typename GridT::TreeType::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  // Node by node: the iterator of a tree looks for its place in the root's table at each step.
  addTiles(tree.root(), info);
  std::vector<const Upper*> uppers;
  tree.getNodes(uppers);
  for (const Upper* node : uppers) addTiles(*node, info);
  std::vector<const Lower*> lowers;
  tree.getNodes(lowers);
  for (const Lower* node : lowers) addTiles(*node, info);
}

GridInfo describe(const openvdb::GridBase& grid) {
  GridInfo info;
  info.name = grid.getName();
  info.valueType = grid.valueType();
  info.gridClass = describeClass(grid.getGridClass());
  info.transform = describeTransform(grid.transform());
  const openvdb::Vec3d voxelSize = grid.transform().voxelSize();
  std::copy(voxelSize.asPointer(), voxelSize.asPointer() + 3, info.voxelSize);
  info.activeVoxels = grid.activeVoxelCount();
  info.leaves = grid.constBaseTree().leafCount();
  info.tiles = static_cast<std::size_t>(grid.constBaseTree().activeTileCount());
  info.memoryBytes = grid.memUsage();
  if (info.activeVoxels > 0) {
    const openvdb::CoordBBox bounds = grid.evalActiveVoxelBoundingBox();
    std::copy(bounds.min().asPointer(), bounds.min().asPointer() + 3, info.boundsMin);
    std::copy(bounds.max().asPointer(), bounds.max().asPointer() + 3, info.boundsMax);
  }
  addValues<openvdb::FloatGrid>(grid, info);
  addValues<openvdb::DoubleGrid>(grid, info);
  info.whyNot = io::whyNotMeshable(grid);
  if (info.whyNot.empty() && !std::isfinite(info.background)) {
    info.whyNot = "its background is not a finite number";
  }
  if (info.whyNot.empty() && info.activeVoxels == 0) info.whyNot = "it has no active voxels";
  info.meshable = info.whyNot.empty();
  for (auto meta = grid.beginMeta(); meta != grid.endMeta(); ++meta) {
    if (meta->second && !isToldElsewhere(meta->first)) {
      info.metadata.emplace_back(meta->first, meta->second->str());
    }
  }
  return info;
}

std::vector<GridInfo> describeIn(io::VdbReader& reader) {
  std::vector<GridInfo> infos;
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    // OpenVDB frees the nodes of a tree in parallel too.
    base::runIsolated([&] { infos.push_back(describe(*reader.readGrid(n))); });
    infos.back().name = reader.gridName(n);  // tells grids of one name apart
  }
  return infos;
}

}  // namespace

GridInfo describeGrid(const openvdb::GridBase& grid) {
  GridInfo info;
  base::runIsolated([&] { info = describe(grid); });  // OpenVDB counts in parallel
  return info;
}

std::string io::whyNotMeshable(const openvdb::GridBase& grid) {
  if (!grid.isType<openvdb::FloatGrid>() && !grid.isType<openvdb::DoubleGrid>()) {
    return "its values are of type " + grid.valueType() + ", not float or double";
  }
  if (!grid.transform().isLinear()) return "its transform is a frustum, not linear";
  return whyOutOfRange(grid);
}

std::string io::whyOutOfRange(const openvdb::GridBase& grid) {
  if (!grid.transform().isLinear()) return {};
  const openvdb::Vec3d origin = grid.transform().indexToWorld(openvdb::Vec3d(0));
  base::Lattice lattice{{origin[0], origin[1], origin[2]}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d unit(0);
    unit[axis] = 1;
    const openvdb::Vec3d step = grid.transform().baseMap()->applyJacobian(unit);
    lattice.steps[axis] = {step[0], step[1], step[2]};
  }
  return base::whyOutOfRange(lattice);
}

std::vector<GridInfo> describeGrids(const std::filesystem::path& path) {
  io::VdbReader reader(path);
  return describeIn(reader);
}

std::vector<GridInfo> describeGrids(const FileBytes& file) {
  io::VdbReader reader(file);
  return describeIn(reader);
}

}  // namespace tufa
