#pragma once

#include <openvdb/openvdb.h>

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/progress.h>

namespace tufa {

/// Options of voxelize().
struct VoxelizeOptions {
  double voxelSize = 0;  ///< world units, must be given
  double halfWidth = 3;  ///< of the narrow band, in voxels: 1 to 1000
  int threads = 0;       ///< most threads; 0: all
  Progress progress;     ///< called from the calling thread; may cancel
  /// Most voxels of the band, in estimate from the mesh's area: more are refused as LimitExceeded.
  /// One vertex far away makes gigabytes of them.
  double bandVoxels = 1 << 27;
};

/// Converts a mesh to a narrow-band level set with OpenVDB's meshToVolume. Distances are exact
/// within a voxel of the mesh; farther out, beyond its edges, they may be too large by about a
/// tenth of a voxel. The mesh should be closed; an open one gives an unsigned shell that OpenVDB
/// decides the inside of. Throws Error: InvalidArgument (voxel size, half width, empty mesh),
/// LimitExceeded
/// (bandVoxels), Cancelled.
[[nodiscard]] TUFA_API openvdb::FloatGrid::Ptr voxelize(const Mesh& mesh,
                                                        const VoxelizeOptions& options);

}  // namespace tufa
