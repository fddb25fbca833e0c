#pragma once

#include <openvdb/openvdb.h>

#include <tufa/contour.h>
#include <tufa/mesh.h>
#include <cstddef>
#include <string>
#include <vector>

namespace tufa {

/// Options of buildLods().
struct LodOptions {
  /// How the surface is read and level 0 is made. `tolerance` is that of level 0; `uniform` is not
  /// looked at.
  ContourOptions contour;
  int levels = 5;     ///< most levels, at least 1
  double factor = 4;  ///< each level's tolerance over that of the level before; above 1
  /// Tolerances of all levels in voxels, rising, in place of `levels` and `factor`.
  std::vector<double> tolerances;
  /// The projected error, in pixels, at which a level comes in; see Lod::screenCoverage.
  double pixelError = 1;
  int screenHeight = 1080;  ///< pixels, for Lod::screenCoverage
};

/// One level of detail.
struct Lod {
  Mesh mesh;
  double tolerance = 0;     ///< voxels
  Certificate certificate;  ///< distance to the uniform mesh of the grid
  /// Draw this level while the model's bounding sphere takes at least this share of the screen's
  /// height: below, the next level's error is no more than LodOptions::pixelError. 0 for the last.
  double screenCoverage = 0;
  std::size_t intersectionsLeft = 0;  ///< pairs of polygons that meet and could not be mended
  double seconds = 0;                 ///< wall clock, without what all levels share
};

/// Levels of detail of one surface, the finest first. All have the topology of the uniform mesh;
/// errors rise and triangles fall from level to level.
struct LodChain {
  std::vector<Lod> levels;
  double voxelSize = 1;      ///< world units: the cube root of a voxel's volume
  Position centre;           ///< of the bounding sphere of level 0
  double radius = 0;         ///< of that sphere, world units
  double sharedSeconds = 0;  ///< wall clock of what all levels share: reading, level 0, forest
  /// Why there are fewer levels than asked for; empty if there are not.
  std::string stopped;
};

/// Where a model is seen from.
struct Camera {
  Position eye;                     ///< world space
  double verticalAngle = 0.785398;  ///< of view, radians
  int screenHeight = 1080;          ///< pixels
};

/// Makes levels of detail of the surface of `grid`: each a cut of one forest, so that the volume is
/// read once. See contour() for what each mesh keeps, and for the errors thrown; throws
/// Error(InvalidArgument) for options out of their range, too.
[[nodiscard]] LodChain buildLods(const openvdb::GridBase& grid, const LodOptions& options = {},
                                 ContourReport* report = nullptr);

/// The coarsest level whose certified error is seen under at most `pixelError` pixels; 0 if there
/// is none.
[[nodiscard]] std::size_t selectLod(const LodChain& chain, const Camera& camera,
                                    double pixelError = 1);

}  // namespace tufa
