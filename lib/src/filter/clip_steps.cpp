// Boxes and masks.

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Prune.h>

#include <tufa/error.h>
#include <cmath>
#include <string>

#include "filter/clip_places.h"
#include "filter/clipper.h"
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

/// The active voxels of a grid or, if `inside`, the inside of a level set, on their own lattice.
BoolGrid::Ptr maskOf(const openvdb::GridBase& source, bool inside) {
  if (!source.transform().isLinear()) {
    throw Error(ErrorCode::UnsupportedGrid, "the transform of the mask \"" + source.getName() +
                                                "\" is a frustum; it must be linear");
  }
  BoolGrid::Ptr chosen = inside ? insideOf(source) : nullptr;
  if (!chosen) chosen = activeOf(source);
  chosen->setTransform(source.transform().copy());
  openvdb::tools::prune(chosen->tree());
  return chosen;
}

}  // namespace

template <class GridT>
void clipToBox(GridT& grid, const ClipBox& step, ProgressInterrupter& interrupter) {
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
  openvdb::CoordBBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = voxelAt(std::floor(least[axis]));
    box.max()[axis] = voxelAt(std::floor(greatest[axis]));
  }
  const BoxPlaces places(box);
  Clipper<GridT, BoxPlaces>(grid, places, interrupter).run();
}

template <class GridT>
void clipToGrid(GridT& grid, const openvdb::GridBase* mask, bool inside,
                ProgressInterrupter& interrupter) {
  if (mask == nullptr) throw Error(ErrorCode::InvalidArgument, "there is no grid to clip to");
  const MaskPlaces places(maskOf(*mask, inside), grid.constTransform());
  Clipper<GridT, MaskPlaces>(grid, places, interrupter).run();
}

#define TUFA_STEPS(GridT)                                                \
  template void clipToBox(GridT&, const ClipBox&, ProgressInterrupter&); \
  template void clipToGrid(GridT&, const openvdb::GridBase*, bool, ProgressInterrupter&)
TUFA_STEPS(openvdb::FloatGrid);
TUFA_STEPS(openvdb::DoubleGrid);
#undef TUFA_STEPS

}  // namespace tufa::filter
