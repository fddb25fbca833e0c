#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <tufa/mesh.h>

#include "creases/vertex_sides.h"

namespace tufa::polygons {

/// Where the surface crosses the lattice edge that a quad stands around.
struct LatticeCrossing {
  openvdb::Vec3d point;
  openvdb::Vec3d outward;  ///< along the edge, of the length of a voxel
};

/// Compares the two ways to split one quad: along its diagonal from corner 0 to corner 2, or along
/// the second, from 1 to 3.
///
/// Beside a crease the better diagonal is the one whose triangles lie on one smooth side each. Else,
/// if the two differ by more than a fiftieth of a voxel, it is the one nearer to the crossing, where
/// the surface is known to be, unless that folds a triangle over; else the shorter one, which has the
/// better angles.
class SplitChooser {
 public:
  SplitChooser(const Mesh& mesh, const Quad& quad, double voxelSize);

  /// `crossing` gives the LatticeCrossing; it is called only if it is needed.
  template <class Crossing>
  [[nodiscard]] bool isSecondDiagonalBetter(const Crossing& crossing) const {
    const bool second = isSecondShorter();
    if (isNearlyFlat() && !isFolded(second)) return second;
    return compareAt(crossing());
  }

  template <class Crossing>
  [[nodiscard]] bool isSecondDiagonalBetterAtCrease(const creases::VertexSides& sides,
                                                    const Crossing& crossing) const {
    const creases::QuadSides around(mesh_, sides, quad_);
    const bool fits[2] = {around.fits(false), around.fits(true)};
    if (fits[0] != fits[1]) return fits[1];
    return isSecondDiagonalBetter(crossing);
  }

 private:
  [[nodiscard]] bool isSecondShorter() const;
  [[nodiscard]] bool isNearlyFlat() const;
  [[nodiscard]] bool isFolded(bool second) const;
  [[nodiscard]] bool compareAt(const LatticeCrossing& crossing) const;

  const Mesh& mesh_;
  const Quad& quad_;
  double voxelSize_;
  std::array<openvdb::Vec3d, 4> corners_;
};

}  // namespace tufa::polygons
