#pragma once

#include <tufa/export.h>
#include <tufa/openvdb_fwd.h>
#include <tufa/progress.h>
#include <memory>
#include <vector>

namespace tufa {

/// Options of uniteLevelSets().
struct UniteOptions {
  /// Most active voxels, in estimate, that a level set may have once it is sampled on the lattice
  /// of the result: more are refused as LimitExceeded.
  double mostVoxels = 1 << 28;
  int threads = 0;  ///< most threads; 0: as many as the TBB arena allows. Never changes the result.
  Progress progress;  ///< called from the calling thread; may cancel
};

/// The union of level sets, by OpenVDB's tools::csgUnion(): one level set, inside where any of them
/// is. Grids without active voxels count for nothing.
///
/// The result has the transform and the metadata of the grid with the smallest voxels, the first
/// among equals, the narrowest of the bands, and doubles if a grid has. Level sets with another
/// transform are sampled on that lattice as by Resample, which rounds their edges by a part of a
/// voxel. Where surfaces cross, the distances beside them are those to either surface.
///
/// Throws Error: UnsupportedGrid (a grid that is no level set of floats or doubles; where the
/// transforms differ, one whose voxels are no cubes, a band narrower than a voxel of the result, or
/// a place beyond the result's lattice), NonFiniteValues, InvalidArgument (no grid), LimitExceeded
/// (mostVoxels), Cancelled.
[[nodiscard]] TUFA_API std::shared_ptr<openvdb::GridBase> uniteLevelSets(
    const std::vector<std::shared_ptr<const openvdb::GridBase>>& grids,
    const UniteOptions& options = {});

}  // namespace tufa
