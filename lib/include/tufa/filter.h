#pragma once

#include <tufa/contour.h>
#include <tufa/export.h>
#include <tufa/mesh.h>
#include <tufa/openvdb_fwd.h>
#include <tufa/progress.h>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace tufa {

/// How Smooth works on values.
enum class Smoothing {
  Gaussian,   ///< four means, which come near to a Gaussian
  Mean,       ///< the mean of 3^3 voxels
  Median,     ///< the median of 3^3 voxels
  Curvature,  ///< a step of mean curvature flow; level sets only
};

/// Smooths the values of active voxels, by tools::LevelSetFilter or tools::Filter of OpenVDB.
struct Smooth {
  Smoothing smoothing = Smoothing::Gaussian;  ///< how
  int iterations = 1;                         ///< how often, 1 to 1000
};

/// Moves the surface of a level set outward, or inward if the distance is below 0.
struct Offset {
  double distance = 0;  ///< world units, at most 1000 voxels
};

/// Moves the surface of a level set inward and back: takes away what is thinner than twice the
/// distance, and rounds convex edges.
struct Open {
  double distance = 0;  ///< world units, above 0 and at most 1000 voxels
};

/// Moves the surface of a level set outward and back: closes gaps and holes narrower than twice the
/// distance, and rounds concave edges.
struct Close {
  double distance = 0;  ///< world units, above 0 and at most 1000 voxels
};

/// Samples the grid anew with voxels of another size: a level set by distances to its mesh,
/// other grids trilinearly. Where voxels are no cubes the ratio of their edges stays.
struct Resample {
  double voxelSize = 0;  ///< world units: the cube root of a voxel's volume
};

/// Keeps what lies in a box. The surface of a level set ends at the box, open, unless
/// ContourOptions::cap closes it; other grids have their background beyond it.
struct ClipBox {
  Position least{0, 0, 0};     ///< corner, world space
  Position greatest{0, 0, 0};  ///< opposite corner, world space
};

/// As ClipBox, with the active voxels of a grid of any type in place of a box.
struct ClipGrid {
  std::shared_ptr<const openvdb::GridBase> grid;  ///< with a linear transform
};

/// As ClipGrid, but the inside of a level set counts, not the voxels of its band.
struct Mask {
  std::shared_ptr<const openvdb::GridBase> grid;  ///< with a linear transform
};

/// Takes away all but the connected components of the inside with the most voxels. Voxels that
/// share a face are connected. Which side is inside is up to FilterOptions.
struct KeepLargest {
  std::size_t count = 1;  ///< components to keep, above 0
};

/// Takes away connected components of the inside with fewer voxels.
struct MinComponent {
  std::size_t voxels = 1;  ///< of the smallest component to keep
};

/// One step.
using Filter = std::variant<Smooth, Offset, Open, Close, Resample, ClipBox, ClipGrid, Mask,
                            KeepLargest, MinComponent>;

/// Options of applyFilters().
struct FilterOptions {
  /// For components: the value on their surface, and the side that is inside, as ContourOptions has
  /// them.
  std::optional<double> isovalue;
  Inside inside = Inside::Auto;  ///< see isovalue
  /// What to do with NaN and infinite values, before the first step: filters would spread them.
  NonFinite nonFinite = NonFinite::Refuse;
  /// Most active voxels, in estimate, that resampling may make: more are refused as LimitExceeded.
  double mostVoxels = 1 << 28;
  int threads = 0;  ///< most threads; 0: as many as the TBB arena allows. Never changes the result.
  Progress progress;  ///< called from the calling thread; may cancel
};

/// What one step did.
struct FilterReport {
  std::string filter;               ///< its name: "smooth", "keep-largest", ...
  std::size_t voxelsBefore = 0;     ///< active ones
  std::size_t voxelsAfter = 0;      ///< active ones
  std::size_t components = 0;       ///< of KeepLargest and MinComponent: how many were found
  std::size_t componentsKept = 0;   ///< of these
  std::size_t nonFiniteValues = 0;  ///< of the first step: how many were taken as outside
  double seconds = 0;               ///< wall clock
};

/// Applies filters to a float or double grid, in their order, and returns the resulting grid; the
/// one given stays as it is. Throws Error: UnsupportedGrid (a filter for level sets on another
/// grid, voxels that are no cubes where OpenVDB needs them, a background that is inside),
/// InvalidArgument (an option out of its range), NonFiniteValues, LimitExceeded (mostVoxels),
/// Cancelled.
[[nodiscard]] TUFA_API std::shared_ptr<openvdb::GridBase> applyFilters(
    const openvdb::GridBase& grid, const std::vector<Filter>& filters,
    const FilterOptions& options = {}, std::vector<FilterReport>* reports = nullptr);

}  // namespace tufa
