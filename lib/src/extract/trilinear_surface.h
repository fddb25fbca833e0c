#pragma once

#include <tufa/mesh.h>

#include <optional>

#include "base/vec3.h"
#include "grid/trilinear_reader.h"

namespace tufa::extraction {

/// The isosurface of the trilinear interpolant, seen from points near it. Points are counted from
/// the volume's affine.origin(), distances are in voxels. For one thread.
class TrilinearSurface {
 public:
  /// How far the surface is looked for.
  static constexpr double kReach = 1;

  /// A point of the surface.
  struct Foot {
    Vec3 point{0.0};
    Normal normal;
    double distance = 0;  ///< of the point that it is the foot of
    Vec3 outward{0.0};    ///< unit vector along the gradient at that point
  };

  explicit TrilinearSurface(const grid::Volume& volume) : volume_(volume), field_(volume) {}

  /// Where the line through a point along the gradient there meets the surface, by bisection;
  /// nothing if it does not within `reach`, or if there is no gradient.
  [[nodiscard]] std::optional<Foot> footOf(const Vec3& point, double reach);

  /// The distance of a point: to first order where that is at most `tolerance`, else that of its
  /// foot; kReach if it has none.
  [[nodiscard]] double distanceOf(const Vec3& point, double tolerance);

 private:
  const grid::Volume& volume_;
  grid::TrilinearReader field_;
};

}  // namespace tufa::extraction
