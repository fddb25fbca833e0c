// Boxes and masks, by OpenVDB's own tools.

#include <openvdb/openvdb.h>
#include <openvdb/tools/Clip.h>
#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/LevelSetUtil.h>

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "filter/steps.h"

namespace tufa::filter {
namespace {

using openvdb::BoolGrid;
using openvdb::MaskGrid;

// Of points only the tree is read, and that without OpenVDB's points library.
using MaskTypes =
    openvdb::NumericGridTypes::Append<openvdb::Vec3GridTypes>::Append<BoolGrid, MaskGrid>;

/// A grid of the same active voxels, all of them true.
template <class TreeT>
BoolGrid::Ptr topologyOf(const TreeT& tree) {
  return BoolGrid::create(
      BoolGrid::TreePtrType(new openvdb::BoolTree(tree, false, true, openvdb::TopologyCopy())));
}

/// The inside of a level set, or null for any other grid.
BoolGrid::Ptr insideOf(const openvdb::GridBase& grid) {
  if (grid.getGridClass() != openvdb::GRID_LEVEL_SET) return nullptr;
  BoolGrid::Ptr inside;
  grid.apply<openvdb::RealGridTypes>([&](const auto& typed) {
    inside = BoolGrid::create(openvdb::tools::sdfInteriorMask(typed.tree()));
  });
  return inside;
}

BoolGrid::Ptr activeOf(const openvdb::GridBase& grid) {
  BoolGrid::Ptr active;
  grid.apply<MaskTypes>([&](const auto& typed) { active = topologyOf(typed.tree()); });
  if (active) return active;
  throw Error(ErrorCode::UnsupportedGrid,
              "grid \"" + grid.getName() + "\" of type " + grid.type() + " cannot be a mask");
}

/// The mask on the lattice of the grid that it is for: each voxel as that of the mask at its place.
MaskGrid::Ptr maskOf(const openvdb::GridBase& source, bool inside,
                     const openvdb::math::Transform& transform) {
  if (!source.transform().isLinear()) {
    throw Error(ErrorCode::UnsupportedGrid, "the transform of the mask \"" + source.getName() +
                                                "\" is a frustum; it must be linear");
  }
  BoolGrid::Ptr chosen = inside ? insideOf(source) : nullptr;
  if (!chosen) chosen = activeOf(source);
  chosen->setTransform(source.transform().copy());
  if (chosen->constTransform() != transform) {
    auto resampled = BoolGrid::create(false);
    resampled->setTransform(transform.copy());
    openvdb::util::NullInterrupter nobody;
    openvdb::tools::resampleToMatch<openvdb::tools::PointSampler>(*chosen, *resampled, nobody);
    chosen = resampled;
  }
  const MaskGrid::TreePtrType tree(
      new openvdb::MaskTree(chosen->tree(), false, true, openvdb::TopologyCopy()));
  return MaskGrid::create(tree);
}

/// Around all leaves, and all tiles that are not background.
template <class GridT>
openvdb::CoordBBox boundsOf(const GridT& grid) {
  openvdb::CoordBBox box;
  grid.tree().evalLeafBoundingBox(box);
  auto tile = grid.tree().cbeginValueAll();
  tile.setMaxDepth(GridT::TreeType::DEPTH - 2);
  for (; tile; ++tile) {
    if (tile.isValueOn() || tile.getValue() != grid.background()) {
      box.expand(tile.getBoundingBox());
    }
  }
  return box;
}

/// What OpenVDB's clipping leaves out.
template <class GridT>
typename GridT::Ptr withMetadataOf(const GridT& source, const typename GridT::Ptr& clipped) {
  clipped->insertMeta(source);
  return clipped;
}

}  // namespace

template <class GridT>
typename GridT::Ptr clipToBox(const GridT& grid, const ClipBox& step) {
  const Position& a = step.least;
  const Position& b = step.greatest;
  const bool sound = a.x < b.x && a.y < b.y && a.z < b.z && std::isfinite(a.x + a.y + a.z) &&
                     std::isfinite(b.x + b.y + b.z);
  if (!sound) {
    throw Error(
        ErrorCode::InvalidArgument,
        "a box to clip to needs finite corners, the least below the greatest in x, y and z");
  }
  openvdb::Vec3d least, greatest;
  openvdb::math::calculateBounds(grid.constTransform(), {a.x, a.y, a.z}, {b.x, b.y, b.z}, least,
                                 greatest);
  // As tools::clip() does, but in what the grid holds: of a larger box it would fill all.
  const openvdb::CoordBBox held = boundsOf(grid);
  openvdb::CoordBBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = held.min()[axis], high = held.max()[axis];
    if (held.empty() || !(std::floor(least[axis]) <= high && std::floor(greatest[axis]) >= low)) {
      return withMetadataOf(grid, openvdb::tools::clip_internal::doClip(grid, MaskGrid(), true));
    }
    box.min()[axis] = static_cast<std::int32_t>(std::max(low, std::floor(least[axis])));
    box.max()[axis] = static_cast<std::int32_t>(std::min(high, std::floor(greatest[axis])));
  }
  MaskGrid mask;
  mask.fill(box, true);
  return withMetadataOf(grid, openvdb::tools::clip_internal::doClip(grid, mask, true));
}

template <class GridT>
typename GridT::Ptr clipToGrid(const GridT& grid, const openvdb::GridBase* mask, bool inside) {
  if (mask == nullptr) throw Error(ErrorCode::InvalidArgument, "there is no grid to clip to");
  const MaskGrid::Ptr places = maskOf(*mask, inside, grid.constTransform());
  // tools::clip() for grids is this behind a resampling that C++20 does not compile with oneTBB.
  return withMetadataOf(grid, openvdb::tools::clip_internal::doClip(grid, *places, true));
}

#define TUFA_STEPS(GridT)                                      \
  template GridT::Ptr clipToBox(const GridT&, const ClipBox&); \
  template GridT::Ptr clipToGrid(const GridT&, const openvdb::GridBase*, bool)
TUFA_STEPS(openvdb::FloatGrid);
TUFA_STEPS(openvdb::DoubleGrid);
#undef TUFA_STEPS

}  // namespace tufa::filter
