#pragma once

#include <tufa/mesh.h>
#include <array>

#include "base/vec3.h"
#include "uniform/vertex_sheets.h"

namespace tufa::uniform {

/// Where the surface crosses the lattice edge that a quad stands around.
struct LatticeCrossing {
  Vec3 point;
  Vec3 outward;  ///< along the edge, of the length of a voxel
};

/// Compares the two ways to split one quad: along its diagonal from corner 0 to corner 2, or along
/// the second, from 1 to 3.
///
/// Beside a crease the better diagonal is the one whose triangles lie on one smooth sheet each.
/// Else, if the two differ by more than a fiftieth of a voxel, it is the one nearer to the
/// crossing, where the surface is known to be, unless that folds a triangle over; else the shorter
/// one, which has the better angles.
class SplitChooser {
 public:
  SplitChooser(const Mesh& mesh, const Quad& quad, double voxelSize);

  /// `crossing` gives the LatticeCrossing; it is called only if it is needed.
  template <class Crossing>
  [[nodiscard]] bool isSecondDiagonalBetter(const Crossing& crossing) const {
    const bool second = isSecondShorter();
    return isFlatAndConvex(second) ? second : compareAt(crossing());
  }

  template <class Crossing>
  [[nodiscard]] bool isSecondDiagonalBetterAtCrease(const VertexSheets& sheets,
                                                    const Crossing& crossing) const {
    if (!QuadSheets::isOneSheet(mesh_, sheets, quad_)) {
      const QuadSheets around(mesh_, sheets, quad_);
      const bool fits[2] = {around.fits(false), around.fits(true)};
      if (fits[0] != fits[1]) return fits[1];
    }
    return isSecondDiagonalBetter(crossing);
  }

 private:
  // Diagonals whose lines are less than this apart, in voxels, are equally near to the surface.
  static constexpr double kSameDistance = 0.02;

  [[nodiscard]] bool isSecondShorter() const {
    return (corners_[3] - corners_[1]).squaredLength() <
           (corners_[2] - corners_[0]).squaredLength();
  }
  // Whether the two diagonals, as lines, are less than kSameDistance apart, and the chosen one
  // separates two triangles that face alike.
  [[nodiscard]] bool isFlatAndConvex(bool second) const {
    const Vec3 diagonals[2] = {corners_[2] - corners_[0], corners_[3] - corners_[1]};
    const Vec3 across = diagonals[0].cross(diagonals[1]);
    const double squared = across.squaredLength();
    const double gap = across.dot(corners_[1] - corners_[0]);
    const double limit = kSameDistance * voxelSize_;
    if (gap * gap >= limit * limit * squared) return false;
    // `across` is the sum of the normals of the two triangles; both must have a part in it. The
    // scalar product of two cross products, by Lagrange's identity.
    const Vec3& chosen = diagonals[second ? 1 : 0];
    const Vec3 other = second ? -diagonals[0] : diagonals[1];
    const Vec3 side = second ? corners_[2] - corners_[1] : corners_[1] - corners_[0];
    const double part =
        side.dot(chosen) * chosen.dot(other) - side.dot(other) * chosen.squaredLength();
    return part > 0 && part < squared;
  }
  [[nodiscard]] bool compareAt(const LatticeCrossing& crossing) const;

  const Mesh& mesh_;
  const Quad& quad_;
  double voxelSize_;
  std::array<Vec3, 4> corners_;
};

}  // namespace tufa::uniform
