// The union of level sets on one lattice.

#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tree/LeafManager.h>
#include <tufa/unite.h>

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/job.h"
#include "base/number_text.h"
#include "filter/steps.h"
#include "grid/non_finite.h"
#include "grid/volume.h"

namespace tufa {
namespace {

using filter::ProgressInterrupter;
using openvdb::GridBase;

[[noreturn]] void refuse(const GridBase& grid, const std::string& why) {
  throw Error(ErrorCode::UnsupportedGrid,
              "a union takes level sets: grid \"" + grid.getName() + "\" " + why);
}

double backgroundOf(const GridBase& grid) {
  double background = 0;
  grid.apply<openvdb::RealGridTypes>(
      [&](const auto& typed) { background = static_cast<double>(typed.background()); });
  return background;
}

std::size_t countNonFinite(const GridBase& grid) {
  std::size_t count = 0;
  grid.apply<openvdb::RealGridTypes>([&](const auto& typed) {
    for (auto value = typed.cbeginValueAll(); value; ++value) {
      if (!std::isfinite(*value)) ++count;
    }
  });
  return count;
}

void requireUnitable(const GridBase& grid) {
  grid::requireMeshable(grid);
  if (grid.getGridClass() != openvdb::GRID_LEVEL_SET) refuse(grid, "is none");
  grid::requireFiniteBackground(grid.getName(), backgroundOf(grid));
  if (!(backgroundOf(grid) > 0)) {
    refuse(grid, "has the background " + base::numberText(backgroundOf(grid)) +
                     ", which must be the width of its band");
  }
  const std::size_t broken = countNonFinite(grid);
  if (broken == 0) return;
  throw Error(ErrorCode::NonFiniteValues,
              "grid \"" + grid.getName() + "\" has " + std::to_string(broken) +
                  " NaN or infinite values, which have no place in a union");
}

/// What the result is like.
struct Target {
  const GridBase* lattice = nullptr;  ///< the grid whose transform it has
  double band = 0;                    ///< half width, world units
  bool doubles = false;
};

// The volume of a mirrored grid is below 0.
double voxelSizeOf(const GridBase& grid) {
  return std::cbrt(std::abs(grid.transform().voxelVolume()));
}

bool isOnLattice(const GridBase& grid, const Target& target) {
  return grid.constTransform() == target.lattice->constTransform();
}

Target chooseTarget(const std::vector<const GridBase*>& grids) {
  Target target{grids.front(), backgroundOf(*grids.front())};
  for (const GridBase* grid : grids) {
    if (voxelSizeOf(*grid) < voxelSizeOf(*target.lattice)) target.lattice = grid;
    target.band = std::min(target.band, backgroundOf(*grid));
    target.doubles = target.doubles || grid->isType<openvdb::DoubleGrid>();
  }
  return target;
}

/// Throws Error unless a grid can be sampled on the lattice of the result.
void requireRoom(const GridBase& grid, const Target& target, double mostVoxels) {
  if (isOnLattice(grid, target)) return;
  for (const GridBase* each : {&grid, target.lattice}) {
    if (each->hasUniformVoxels()) continue;
    refuse(*each, "has voxels that are no cubes, and grid \"" +
                      (each == &grid ? target.lattice : &grid)->getName() +
                      "\" another transform; neither can be sampled on the other's lattice");
  }
  if (target.band < voxelSizeOf(*target.lattice)) {
    refuse(*target.lattice, "is to hold bands of " + base::numberText(target.band) +
                                " world units, less than its voxel");
  }
  const double factor = voxelSizeOf(*target.lattice) / voxelSizeOf(grid);
  const double voxels = static_cast<double>(grid.activeVoxelCount()) / (factor * factor);
  if (!(voxels <= mostVoxels)) {
    throw Error(ErrorCode::LimitExceeded, "the union would sample grid \"" + grid.getName() +
                                              "\" in about " + base::numberText(voxels) +
                                              " voxels, more than " + base::numberText(mostVoxels) +
                                              "; resample the finest grid first");
  }
  constexpr double kFarthest = 1 << 30;  // leaves room for the coordinates of nodes
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  for (int corner = 0; corner < 8; ++corner) {
    openvdb::Vec3d place = box.min().asVec3d();
    for (int i = 0; i < 3; ++i) {
      if ((corner >> i & 1) != 0) place[i] = box.max()[i];
    }
    place = target.lattice->transform().worldToIndex(grid.transform().indexToWorld(place));
    for (int i = 0; i < 3; ++i) {
      if (std::abs(place[i]) < kFarthest) continue;
      refuse(grid,
             "lies too far away for the voxels of grid \"" + target.lattice->getName() + "\"");
    }
  }
}

/// Cuts a band to its new half width.
template <class GridT>
void narrowBand(GridT& grid, typename GridT::ValueType band) {
  using Value = typename GridT::ValueType;
  if (grid.background() == band) return;
  openvdb::tree::LeafManager<typename GridT::TreeType> leaves(grid.tree());
  leaves.foreach ([band](auto& leaf, std::size_t) {
    for (auto value = leaf.beginValueOn(); value; ++value) {
      if (std::abs(*value) < band) continue;
      const Value end = *value < 0 ? -band : band;
      leaf.setValueOff(value.pos(), end);
    }
  });
  openvdb::tools::changeLevelSetBackground(grid.tree(), band);
}

/// A copy of a level set as part of the union: of the result's type, lattice and band.
template <class GridT>
typename GridT::Ptr partOf(const GridBase& grid, const Target& target,
                           ProgressInterrupter& interrupter) {
  typename GridT::Ptr part;
  grid.apply<openvdb::RealGridTypes>([&](const auto& typed) {
    part = openvdb::GridBase::grid<GridT>(openvdb::GridBase::Ptr(new GridT(typed)));
  });
  const auto band = static_cast<typename GridT::ValueType>(target.band);
  if (!isOnLattice(grid, target)) {
    auto sampled = GridT::create(band);
    sampled->setGridClass(openvdb::GRID_LEVEL_SET);
    sampled->setTransform(target.lattice->transform().copy());
    filter::sampleOnto(*part, *sampled, interrupter);
    part = sampled;
  }
  narrowBand(*part, band);
  return part;
}

template <class GridT>
GridBase::Ptr unite(const std::vector<const GridBase*>& grids, const Target& target,
                    const Progress& progress) {
  typename GridT::Ptr sum;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const auto share = [&](std::size_t done) {
      return static_cast<double>(done) / static_cast<double>(grids.size());
    };
    ProgressInterrupter interrupter(progress, "unite", share(i), share(i + 1));
    typename GridT::Ptr part;
    if (!interrupter.wasInterrupted(0)) part = partOf<GridT>(*grids[i], target, interrupter);
    if (interrupter.cancelled() || interrupter.wasInterrupted(100)) {
      throw Error(ErrorCode::Cancelled, "cancelled while level sets were united");
    }
    if (sum) {
      openvdb::tools::csgUnion(*sum, *part);
    } else {
      sum = part;
    }
  }
  sum->clearMetadata();
  sum->insertMeta(*target.lattice);
  sum->setGridClass(openvdb::GRID_LEVEL_SET);
  return sum;
}

}  // namespace

std::shared_ptr<GridBase> uniteLevelSets(const std::vector<std::shared_ptr<const GridBase>>& grids,
                                         const UniteOptions& options) {
  std::vector<const GridBase*> full;
  for (const auto& grid : grids) {
    if (grid == nullptr)
      throw Error(ErrorCode::InvalidArgument, "a union of no grid was asked for");
    requireUnitable(*grid);
    if (!grid->empty()) full.push_back(grid.get());
  }
  if (grids.empty()) throw Error(ErrorCode::InvalidArgument, "a union takes one grid at least");
  if (full.empty()) {
    (void)base::Job(options.threads, options.progress).finish();
    return grids.front()->deepCopyGrid();
  }
  const Target target = chooseTarget(full);
  for (const GridBase* grid : full) requireRoom(*grid, target, options.mostVoxels);
  GridBase::Ptr result;
  base::Job(options.threads, {}).run([&] {
    filter::translatingErrors(
        options.progress, "OpenVDB cannot unite these grids", [&](const Progress& progress) {
          result = target.doubles ? unite<openvdb::DoubleGrid>(full, target, progress)
                                  : unite<openvdb::FloatGrid>(full, target, progress);
        });
  });
  return result;
}

}  // namespace tufa
