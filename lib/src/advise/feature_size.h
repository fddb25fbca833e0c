#pragma once

#include "base/vec3.h"
#include "grid/trilinear_reader.h"

namespace tufa::advise {

/// Measures how thick the solid and the gap outside are at points of the surface, along lines
/// through the trilinear field. A line that meets the surface on the other side aslant, as those
/// from edges do, counts by its length across that side. For one thread.
class FeatureSize {
 public:
  FeatureSize(const grid::Volume& volume, double reach)
      : volume_(volume), field_(volume), reach_(reach) {}

  /// The smaller of the two at a point near the surface, counted from the volume's
  /// affine.origin(), with the mean of the unit normals around it; in voxels, at most `reach`.
  [[nodiscard]] double at(const Vec3& point, Vec3 outward);

 private:
  /// The length of a line that begins near the surface, on the side that it goes into. `step` is a
  /// voxel of it in lattice coordinates.
  [[nodiscard]] double alongLine(const Vec3& start, const Vec3& step, bool intoSolid);
  /// The cosine of the angle between a line and the field's gradient at a point.
  [[nodiscard]] double cosineAt(const Vec3& point, const Vec3& step);

  const grid::Volume& volume_;
  grid::TrilinearReader field_;
  double reach_;
};

}  // namespace tufa::advise
