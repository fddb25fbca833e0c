#pragma once

#include <tufa/openvdb_fwd.h>

#include <memory>
#include <optional>
#include <vector>

#include "base/job.h"
#include "base/vec3.h"
#include "grid/isovalue.h"
#include "grid/voxel_frame.h"

namespace tufa::grid {

/// The trilinear interpolant of a grid less the isovalue, in voxel space. For one thread.
class TrilinearField {
 public:
  virtual ~TrilinearField() = default;

  /// A zero of the field near `start`, by Newton steps along the gradient. Nothing if they leave
  /// the data, go further than a few voxels, or do not settle.
  [[nodiscard]] virtual std::optional<Vec3> project(const Vec3& start) = 0;
  /// The field's gradient at a point, as a unit vector; 0 where there is none.
  [[nodiscard]] virtual Vec3 direction(const Vec3& point) = 0;
};

/// The trilinear isosurface of a grid: what meshes are checked against. Found independently of
/// contour()'s own search, so that one can check the other. Keeps references to its arguments.
class Isosurface {
 public:
  virtual ~Isosurface() = default;

  /// Points on it, in voxel space: where it crosses a lattice edge with an active end, and one
  /// inside each cell whose lowest corner is active. A level set has none where its data end.
  [[nodiscard]] virtual std::vector<Vec3> samples(base::Job& job) const = 0;
  [[nodiscard]] virtual std::unique_ptr<TrilinearField> field() const = 0;
};

/// The isosurface of a float or double grid; chooseIsovalue() refuses others. Throws Error as
/// requireFiniteBackground() does.
[[nodiscard]] std::unique_ptr<const Isosurface> isosurfaceOf(const openvdb::GridBase& grid,
                                                             const VoxelFrame& frame,
                                                             const IsoChoice& iso);

}  // namespace tufa::grid
