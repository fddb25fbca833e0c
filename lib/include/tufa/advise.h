#pragma once

#include <tufa/contour.h>
#include <tufa/export.h>
#include <tufa/openvdb_fwd.h>
#include <cstddef>

namespace tufa {

/// Options of adviseSampling().
struct AdviseOptions {
  /// What surface is meant: `isovalue`, `inside`, `nonFinite`, `tileFaces`; and `threads` and
  /// `progress`.
  ContourOptions contour;
  double smoothVoxels = 4;  ///< voxels that a feature of a smooth surface should have
  double sharpVoxels = 8;   ///< voxels that one with creases should have
  double sheetVoxels = 2;   ///< under so many voxels a feature is a thin sheet
  /// Normals in a cell that differ by more, in degrees, mean a crease; 0 to 180.
  double sharpAngle = 25.84;
  /// The share of the surface cells, those with the smallest features, that may go without, and the
  /// share that may have more than one crease: 0 to 1.
  double spared = 0.01;
};

/// Whether the samples of a grid can carry its features, by adviseSampling(). The size of a feature
/// is the thickness of the solid, or of the gap outside, along the normals at the surface.
struct SamplingReport {
  double isovalue = 0;           ///< as used
  bool insideIsBelow = true;     ///< as used
  bool distanceField = false;    ///< values are distances: hidden sheets were looked for
  double voxelSize = 0;          ///< world length of one voxel: the cube root of its volume
  std::size_t surfaceCells = 0;  ///< cells that the surface passes, without those at its open ends
  std::size_t sharpCells = 0;    ///< of these, cells with a crease or corner
  std::size_t thinSmooth = 0;    ///< smooth cells at features under `smoothVoxels`
  std::size_t thinSharp = 0;     ///< sharp cells at features under `sharpVoxels`
  std::size_t thinSheets = 0;    ///< cells at features under `sheetVoxels`
  /// Sharp cells whose tangent planes meet in no point in the cell or a voxel around it, to a
  /// quarter of a voxel: more than one crease or corner is in them.
  std::size_t unresolvedKinks = 0;
  std::size_t sparedCells = 0;  ///< AdviseOptions::spared of the surface cells
  /// Lattice edges between two samples of one side from both of which the distances fall to the
  /// other side: a sheet or a gap that the signs do not show.
  std::size_t hiddenSheets = 0;
  double reachVoxels = 0;   ///< features larger than this were not measured; sizes end there
  double leastVoxels = 0;   ///< size of the smallest feature
  double sparedVoxels = 0;  ///< all but the share `spared` of the cells have features of this size
  double middleVoxels = 0;  ///< half of the cells have smaller features
  /// Pi over `sparedVoxels`, in radians for each world unit: half a period fits into a feature.
  double highestFrequency = 0;
  double nyquist = 0;  ///< pi over the voxel size: the highest frequency that samples can hold
  /// The voxel size at which all but the share `spared` of the cells would have the voxels they
  /// should; no more than the grid's own if that is fine enough, as larger features are not
  /// measured. World units.
  double voxelSizeNeeded = 0;

  /// Whether all was found the same.
  bool operator==(const SamplingReport&) const = default;

  /// Whether the grid is fine enough.
  [[nodiscard]] bool enough() const {
    return voxelSizeNeeded >= voxelSize && unresolvedKinks <= sparedCells && hiddenSheets == 0;
  }
};

/// Tells whether the samples of a grid can carry the features of its surface, before it is meshed.
/// The same for any number of threads.
///
/// Throws Error as contour() does.
[[nodiscard]] TUFA_API SamplingReport adviseSampling(const openvdb::GridBase& grid,
                                                     const AdviseOptions& options = {});

}  // namespace tufa
