#pragma once

#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/progress.h>
#include <tufa/rays.h>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace tufa {

/// Where a picture is taken from.
struct PictureView {
  double azimuth = 35;    ///< of the eye about the axis that points up, degrees from the next one
  double elevation = 25;  ///< of the eye over the plane at right angles to it, degrees
  bool yUp = false;       ///< y points up, not z
  /// Angle between the left and the right side of the picture, degrees up to 170; 0: parallel rays.
  double fieldOfView = 0;
  /// World units from left to right, through the centre; 0: so that all is seen.
  double width = 0;
  std::optional<Position> centre = {};  ///< shown in the middle; unset: so that all is seen
};

/// Options of takePicture() and compareSurfaces().
struct PictureOptions {
  int width = 900;         ///< pixels, 1 to 65535
  int height = 700;        ///< pixels, 1 to 65535
  PictureView view = {};   ///< where from
  int samples = 16;        ///< rays for each pixel, 1 to 65536
  bool shadows = true;     ///< of the main lamp, soft
  bool occlusion = true;   ///< the light from all around is dimmed by what stands before it
  int threads = 0;         ///< most threads; 0: all. Never changes the result.
  Progress progress = {};  ///< called from the calling thread; may cancel
};

/// A picture, row by row from the top.
struct Picture {
  int width = 0;                             ///< pixels
  int height = 0;                            ///< pixels
  std::vector<std::array<float, 3>> pixels;  ///< linear red, green and blue, 0 to 1
  double covered = 0;                        ///< share of the rays that met the surface, 0 to 1
};

/// Takes a picture of a surface: shaded by its normals under a sky, a lamp from the upper left and
/// a weaker one from the right. Throws Error: InvalidArgument (an option out of its range),
/// Cancelled.
[[nodiscard]] TUFA_API Picture takePicture(const RaySurface& surface,
                                           const PictureOptions& options = {});

/// What compareSurfaces() found.
struct SurfaceComparison {
  std::size_t pixels = 0;      ///< that show either surface
  std::size_t silhouette = 0;  ///< of these, where one of them alone is seen
  std::size_t depth = 0;       ///< of these, where both are seen, at different depths
  /// The share of both kinds, 0 to 1; 0 if no pixel shows anything.
  [[nodiscard]] double share() const {
    return pixels > 0 ? static_cast<double>(silhouette + depth) / static_cast<double>(pixels) : 0;
  }
};

/// Compares what is seen of two surfaces, by a ray through the middle of each pixel. Where one
/// alone is seen, the pixel differs if rays moved sideways by `tolerance`, in world units, do not
/// meet the other either; where both are seen, if their depths differ by more than that across the
/// surface, and such rays find neither near the other. The view is fitted to the first, unless that
/// is empty. Throws Error as takePicture() does.
[[nodiscard]] TUFA_API SurfaceComparison compareSurfaces(const RaySurface& a, const RaySurface& b,
                                                         double tolerance,
                                                         const PictureOptions& options = {});

}  // namespace tufa
