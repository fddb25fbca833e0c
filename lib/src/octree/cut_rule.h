#pragma once

#include <tufa/contour.h>
#include <functional>

#include "base/vec3.h"
#include "grid/transform.h"

namespace tufa::octree {

/// What the clusters of a cell must keep for the cell to become a leaf.
struct CutRule {
  double tolerance = 0;         ///< voxels; bound on a cluster's estimated error
  double maxAngle = kAnyAngle;  ///< radians; bound on the angle between two normals of a cluster
  int minLevel = 0;             ///< cells up to this level need not keep the bounds above
  int maxLevel = 31;            ///< no cell above this level
  double minAngle = 0;          ///< degrees; what triangles are to keep where edges are collapsed
  static constexpr double kAnyAngle = 4;
  /// Multiplies the tolerance at a lattice point; empty: 1 everywhere.
  std::function<double(const Vec3&)> scale;

  [[nodiscard]] bool boundsAngle() const { return maxAngle < kAnyAngle; }
  [[nodiscard]] double toleranceAt(const Vec3& point) const {
    return scale ? tolerance * scale(point) : tolerance;
  }
};

/// The largest tolerance that may be asked for, in voxels: beyond it, products overflow floats.
inline constexpr double kLargestTolerance = 1e6;

/// The largest ContourOptions::minAngle, degrees.
inline constexpr double kLargestMinAngle = 30;

/// Throws Error(InvalidArgument) unless the tolerance is from 0 to the largest.
void requireTolerance(double tolerance);

/// Throws Error(InvalidArgument) unless tolerances rise by that factor.
void requireFactor(double factor);

/// Whether edges are to be collapsed after the cut. Bounds on cells bound what one vertex gathers,
/// so they exclude it.
[[nodiscard]] bool maySimplify(const ContourOptions& options);

/// The rule that the options of a call ask for. `transform` is the meshed grid's. Throws
/// Error(InvalidArgument) for an option out of its range.
[[nodiscard]] CutRule readRule(const ContourOptions& options, const grid::Transform& transform);

}  // namespace tufa::octree
