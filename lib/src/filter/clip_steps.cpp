// Boxes and masks, by OpenVDB's own tools.

#include <openvdb/openvdb.h>
#include <openvdb/tools/Clip.h>
#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/LevelSetUtil.h>

#include <tufa/error.h>
#include <cmath>
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
    throw Error(ErrorCode::InvalidArgument,
                "a box to clip to needs a least corner below its greatest one in x, y and z");
  }
  const openvdb::BBoxd box({a.x, a.y, a.z}, {b.x, b.y, b.z});
  return withMetadataOf(grid, openvdb::tools::clip(grid, box));
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
