#pragma once

#include <tufa/contour.h>
#include <tufa/export.h>
#include <tufa/implicit.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <tufa/progress.h>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>

namespace tufa {

/// A half line in world space, or a part of it.
struct Ray {
  Position origin{0, 0, 0};     ///< where distances are counted from
  Position direction{0, 0, 1};  ///< of any length whose square is neither 0 nor infinite
  double least = 0;             ///< what is nearer is passed over: world units, 0 or more
  double greatest = std::numeric_limits<double>::infinity();  ///< what is further is, too
};

/// Where a ray meets a surface.
struct RayHit {
  double distance = 0;       ///< from the ray's origin, world units
  Position point{0, 0, 0};   ///< there
  Normal normal{0, 0, 0};    ///< of the surface, outward; 0 where it has none
  std::size_t triangle = 0;  ///< of a mesh: which one, quads after triangles, each as two
};

/// A surface made ready for rays: of a volume, a field or a mesh. Any number of threads may use it.
class RaySurface;

/// Options of makeRaySurface().
struct RaySurfaceOptions {
  /// Of a volume: its value on the surface; unset: as contour() chooses.
  std::optional<double> isovalue = {};
  Inside inside = Inside::Auto;  ///< of a volume: which side is solid
  int threads = 0;               ///< most threads; 0: all. Never changes the result.
  Progress progress = {};        ///< called from the calling thread; may cancel
};

/// The surface of a float or double grid: that of its trilinear interpolant. Level sets at isovalue
/// 0 with cubes for voxels, and a band of two or more to each side, are searched by OpenVDB's
/// LevelSetRayIntersector, which looks once in each voxel on the way; of others the first crossing
/// in the cells on the way is found. Throws Error as contour() does, and as that by default for NaN
/// and infinite values.
[[nodiscard]] TUFA_API std::shared_ptr<const RaySurface> makeRaySurface(
    std::shared_ptr<const openvdb::GridBase> grid, const RaySurfaceOptions& options = {});

/// The surface of a field. Where the field has a closed form (Field::insideAlong()), its roots are
/// taken. Other rays are halved where the field's bounds, and the interval Newton method
/// on its derivative along the ray, cannot say that they meet no surface: none is stepped over,
/// however thin, but for what rounding hides, some 10^-14 of the coordinates, and for fields
/// whose bounds do not tell after 5,000 halvings. Throws Error:
/// InvalidArgument (a field without finite extent), Cancelled.
[[nodiscard]] TUFA_API std::shared_ptr<const RaySurface> makeRaySurface(
    std::shared_ptr<const implicit::Field> field, const RaySurfaceOptions& options = {});

/// The triangles of a mesh, hit from both sides; no ray passes between neighbours. Throws Error:
/// InvalidArgument (an index out of range, a position that is not finite), Cancelled.
[[nodiscard]] TUFA_API std::shared_ptr<const RaySurface> makeRaySurface(
    const Mesh& mesh, const RaySurfaceOptions& options = {});

/// A box that holds the surface, to within a voxel; without extent if there is none.
[[nodiscard]] TUFA_API implicit::Box boundsOf(const RaySurface& surface);

/// The first place where a ray passes the surface, from either side. Throws
/// Error(InvalidArgument) for numbers that are not finite and a direction of length 0.
[[nodiscard]] TUFA_API std::optional<RayHit> castRay(const RaySurface& surface, const Ray& ray);

}  // namespace tufa
