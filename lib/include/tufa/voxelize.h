#pragma once

#include <openvdb/openvdb.h>

#include <tufa/export.h>
#include <tufa/implicit.h>
#include <tufa/mesh.h>
#include <tufa/progress.h>
#include <cstddef>

namespace tufa {

/// Options of voxelize().
struct VoxelizeOptions {
  double voxelSize = 0;  ///< world units, must be given
  double halfWidth = 3;  ///< of the narrow band, in voxels: 1 to 1000
  int threads = 0;       ///< most threads; 0: all
  Progress progress;     ///< called from the calling thread; may cancel
  /// Most voxels of the band, of a mesh in estimate from its faces: more are refused as
  /// LimitExceeded. One vertex far away makes gigabytes of them. A needle counts three times, as
  /// it fills its blocks of voxels less; so memory stays at about 40 bytes a voxel of the limit.
  double bandVoxels = 1 << 27;
  /// A fog volume in place of a level set: 1 inside, and less within the half width of the surface,
  /// down to 0 on it. Its isovalue for a surface near the true one is small.
  bool fog = false;
  /// Of a mesh: exact distances where it bounds a solid, for about 400 bytes of memory a triangle.
  /// false: those of OpenVDB's meshToVolume everywhere, in a quarter to a half of the time.
  bool exactDistances = true;
};

/// What the distances are that voxelize() has given to a mesh.
enum class MeshDistances {
  Exact,   ///< signed distances to the solid that it bounds
  OpenVdb  ///< those of OpenVDB's meshToVolume
};

/// What voxelize() has done with a field.
struct VoxelizeReport {
  std::size_t samples = 0;       ///< points where the field was evaluated for the grid
  std::size_t blocks = 0;        ///< of 8^3 voxels that its bounds could not leave out
  std::size_t activeVoxels = 0;  ///< of the level set
  /// Voxels that hold a part of the inside, or a gap in it, that none of the samples around show:
  /// smaller than the voxels.
  std::size_t hiddenVoxels = 0;
  /// Voxels of which the bounds, over parts a sixteenth as long, cannot say that they hold none.
  std::size_t undecidedVoxels = 0;
  Position firstHidden{0, 0, 0};  ///< a place in the first of both kinds, in the lattice's order
};

/// Converts a mesh to a narrow-band level set. Distances to a mesh that bounds a solid are exact:
/// closed, no faces intersecting or touching, its parts facing outward, or inward where they are
/// cavities. Of others, and where OpenVDB takes a place two voxels or more from the surface for the
/// other side of it, as behind a channel too narrow for the voxels, they are those of OpenVDB's
/// meshToVolume: beside concave edges the step with which it mends signs makes them too low, of
/// samples next to the surface too, by up to a voxel. An open mesh gives an unsigned shell that
/// OpenVDB decides the inside of. Closed parts are filled, whichever way they face, but those that
/// face inward in others are cavities. `distances`: is told which they are. Throws Error:
/// InvalidArgument (voxel size, half width, empty mesh), LimitExceeded (bandVoxels), Cancelled.
[[nodiscard]] TUFA_API openvdb::FloatGrid::Ptr voxelize(const Mesh& mesh,
                                                        const VoxelizeOptions& options,
                                                        MeshDistances* distances = nullptr);

/// Samples a field as a narrow-band level set, in parallel and only where its bounds cannot leave
/// the surface out. The values are those of implicit::Field::distance(). Samples that are NaN are
/// outside, and the surface is closed around them. Throws Error: InvalidArgument (voxel size, half
/// width, a field without finite extent), LimitExceeded (bandVoxels), Cancelled.
[[nodiscard]] TUFA_API openvdb::FloatGrid::Ptr voxelize(const implicit::Field& field,
                                                        const VoxelizeOptions& options,
                                                        VoxelizeReport* report = nullptr);

}  // namespace tufa
