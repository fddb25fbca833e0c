// Smoothing, offsets and resampling, by OpenVDB's own tools.

#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Filter.h>
#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/LevelSetFilter.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <tufa/error.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "base/lattice_range.h"
#include "base/number_text.h"
#include "filter/steps.h"

namespace tufa::filter {
namespace {

constexpr int kMostIterations = 1000;
constexpr double kMostVoxels = 1000;  ///< of an offset

template <class GridT>
using LevelSetFilter =
    openvdb::tools::LevelSetFilter<GridT, openvdb::FloatGrid, openvdb::util::NullInterrupter>;

template <class GridT>
bool isLevelSet(const GridT& grid) {
  return grid.getGridClass() == openvdb::GRID_LEVEL_SET;
}

/// What OpenVDB's level set tools need.
template <class GridT>
void requireLevelSet(const GridT& grid, const char* what) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ErrorCode::UnsupportedGrid,
                std::string(what) + " needs a level set: grid \"" + grid.getName() + "\" " + why);
  };
  if (!isLevelSet(grid)) refuse("is none");
  if (!grid.hasUniformVoxels()) refuse("has voxels that are no cubes; resample it by other means");
  if (!(grid.background() > 0)) {
    refuse("has the background " + base::numberText(static_cast<double>(grid.background())) +
           ", which must be the width of its band");
  }
}

template <class GridT>
void smoothLevelSet(GridT& grid, const Smooth& step, ProgressInterrupter& interrupter) {
  requireLevelSet(grid, "smoothing");
  LevelSetFilter<GridT> filter(grid, &interrupter);
  for (int i = 0; i < step.iterations && !interrupter.cancelled(); ++i) {
    interrupter.wasInterrupted(100 * i / step.iterations);
    switch (step.smoothing) {
      case Smoothing::Gaussian:
        filter.gaussian();
        break;
      case Smoothing::Mean:
        filter.mean();
        break;
      case Smoothing::Median:
        filter.median();
        break;
      case Smoothing::Curvature:
        filter.meanCurvature();
        break;
    }
  }
}

}  // namespace

template <class GridT>
void smooth(GridT& grid, const Smooth& step, ProgressInterrupter& interrupter) {
  if (step.iterations < 1 || step.iterations > kMostIterations) {
    throw Error(ErrorCode::InvalidArgument,
                "smoothing takes 1 to " + std::to_string(kMostIterations) + " iterations, not " +
                    std::to_string(step.iterations));
  }
  if (isLevelSet(grid) || step.smoothing == Smoothing::Curvature) {
    if (!isLevelSet(grid)) requireLevelSet(grid, "smoothing by curvature");
    smoothLevelSet(grid, step, interrupter);
    return;
  }
  openvdb::tools::Filter<GridT, openvdb::FloatGrid, openvdb::util::NullInterrupter> filter(
      grid, &interrupter);
  switch (step.smoothing) {
    case Smoothing::Gaussian:
      filter.gaussian(1, step.iterations);
      break;
    case Smoothing::Mean:
      filter.mean(1, step.iterations);
      break;
    default:
      filter.median(1, step.iterations);
      break;
  }
}

template <class GridT>
void offset(GridT& grid, const std::vector<double>& distances, ProgressInterrupter& interrupter) {
  requireLevelSet(grid, "an offset");
  const double voxel = grid.voxelSize()[0];
  for (const double distance : distances) {
    if (std::abs(distance) <= kMostVoxels * voxel) continue;  // false for NaN
    throw Error(ErrorCode::InvalidArgument,
                "an offset of " + base::numberText(distance) + " world units is " +
                    base::roughNumberAbove(std::abs(distance) / voxel, kMostVoxels) +
                    " voxels, and at most " + base::numberText(kMostVoxels) +
                    " either way are moved");
  }
  LevelSetFilter<GridT> filter(grid, &interrupter);
  for (const double distance : distances) {
    if (interrupter.cancelled()) return;
    // OpenVDB adds its offset to the distances: above 0 the surface moves inward.
    filter.offset(static_cast<typename GridT::ValueType>(-distance));
  }
}

/// Gives distances without signs those of the level set that they are from, which has them
/// everywhere. Beside the end of an open surface, where the source has no data, the result has none
/// either.
template <class GridT>
void takeSigns(const GridT& source, GridT& result) {
  using Value = typename GridT::ValueType;
  using Tree = typename GridT::TreeType;
  const Value background = result.background();
  const Value band = source.background() - static_cast<Value>(2 * source.voxelSize()[0]);
  const auto signOf = [&](const auto& accessor, const openvdb::Vec3d& place) {
    return openvdb::tools::BoxSampler::sample(accessor, place);
  };
  const auto placeOf = [&](const openvdb::Vec3d& index) {
    return source.transform().worldToIndex(result.transform().indexToWorld(index));
  };
  std::atomic<bool> isOpen{false};
  openvdb::tree::LeafManager<Tree> leaves(result.tree());
  leaves.foreach ([&](auto& leaf, std::size_t) {
    const auto accessor = source.getConstUnsafeAccessor();
    for (auto value = leaf.beginValueAll(); value; ++value) {
      const openvdb::Vec3d place = placeOf(value.getCoord().asVec3d());
      const bool isPast = *value < band && !accessor.isValueOn(openvdb::Coord::round(place));
      if (isPast && value.isValueOn()) isOpen = true, value.setValueOff();
      const Value distance = value.isValueOn() ? *value : background;
      value.setValue(std::copysign(distance, signOf(accessor, place)));
    }
  });
  const auto accessor = source.getConstUnsafeAccessor();
  auto tile = result.tree().beginValueOff();
  tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    const openvdb::Vec3d place = placeOf(tile.getBoundingBox().getCenter());
    tile.setValue(std::copysign(background, signOf(accessor, place)));
  }
  // Insides of thousands of voxels, where the root has no tile.
  if (!isOpen) openvdb::tools::signedFloodFill(result.tree());
}

/// By way of a mesh, from which distances are taken without signs: OpenVDB's own, from a flood
/// from outside, pass neither into cavities nor, where the surface is open, to an inside.
template <class GridT>
void sampleDistances(const GridT& source, GridT& result, ProgressInterrupter& interrupter) {
  // The mesh is of single precision: near the origin.
  const openvdb::Vec3d centre =
      source.transform().indexToWorld(source.evalActiveVoxelBoundingBox().getCenter());
  auto nearby = source.transform().copy(), transform = result.transform().copy();
  nearby->postTranslate(-centre);
  transform->postTranslate(-centre);
  const auto moved = source.copyReplacingMetadataAndTransform(source, nearby);  // of the same tree
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*moved, points, quads);
  for (openvdb::Vec3s& point : points) point = transform->worldToIndex(point);
  const auto halfWidth = static_cast<float>(static_cast<double>(result.background()) /
                                            result.transform().voxelSize()[0]);
  const auto distances = openvdb::tools::meshToVolume<GridT>(
      interrupter,
      openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec4I>(points, quads),
      *transform, halfWidth, halfWidth, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  openvdb::tools::changeBackground(distances->tree(), result.background());
  result.setTree(distances->treePtr());
  takeSigns(source, result);
}

template <class GridT>
void sampleOnto(const GridT& source, GridT& result, ProgressInterrupter& interrupter) {
  if (isLevelSet(source)) {
    sampleDistances(source, result, interrupter);
    return;
  }
  openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(
      source, result, static_cast<openvdb::util::NullInterrupter&>(interrupter));
}

template <class GridT>
typename GridT::Ptr resample(const GridT& grid, const Resample& step, double mostVoxels,
                             ProgressInterrupter& interrupter) {
  base::requireVoxelSize(step.voxelSize);
  const double factor = step.voxelSize / std::cbrt(std::abs(grid.transform().voxelVolume()));
  // A band grows with the surface, other grids with the volume.
  const double voxels =
      static_cast<double>(grid.activeVoxelCount()) / std::pow(factor, isLevelSet(grid) ? 2 : 3);
  if (!(voxels <= mostVoxels)) {
    throw Error(ErrorCode::LimitExceeded, "resampling to voxels of " +
                                              base::numberText(step.voxelSize) + " makes about " +
                                              base::numberText(voxels) + " of them, more than " +
                                              base::numberText(mostVoxels));
  }
  if (isLevelSet(grid)) requireLevelSet(grid, "resampling of distances");
  const double scale = isLevelSet(grid) ? factor : 1;
  auto result = GridT::create(static_cast<typename GridT::ValueType>(grid.background() * scale));
  result->insertMeta(grid);
  result->setGridClass(grid.getGridClass());
  auto transform = grid.transform().copy();
  transform->preScale(factor);
  result->setTransform(transform);
  sampleOnto(grid, *result, interrupter);
  return result;
}

#define TUFA_STEPS(GridT)                                                         \
  template void smooth(GridT&, const Smooth&, ProgressInterrupter&);              \
  template void offset(GridT&, const std::vector<double>&, ProgressInterrupter&); \
  template void sampleOnto(const GridT&, GridT&, ProgressInterrupter&);           \
  template GridT::Ptr resample(const GridT&, const Resample&, double, ProgressInterrupter&)
TUFA_STEPS(openvdb::FloatGrid);
TUFA_STEPS(openvdb::DoubleGrid);
#undef TUFA_STEPS

}  // namespace tufa::filter
