#pragma once

#include <vector>

#include "base/job.h"
#include "reduce/reference_mesh.h"
#include "reduce/surface.h"

namespace tufa::reduce {

/// The largest distance between a surface and its reference, both ways, as a bound.
struct Certificate {
  float largest = 0;    ///< voxels
  float mean = 0;       ///< of the reference vertices from their owners, voxels
  Index halved = 0;     ///< faces of the reference whose bound had to be found by halving
  Index worst = kNone;  ///< a face of the reference at the largest distance
  /// Where it is more than expected, the largest distance over what is expected there; else 1.
  float mostOver = 1;
  /// The faces of the reference where it is more than expected, in rising order.
  std::vector<Index> beyond;
  /// For each region the largest distance at its triangles; empty without regions.
  std::vector<float> ofRegion;
};

/// Measures a surface. What is expected at a vertex of the reference is `expected` times its scale.
///
/// Every reference vertex goes to the nearest point of its owner. An edge of the reference whose
/// ends belong to triangles A and B is cut at the point nearest to what A and B share, which goes
/// to the nearest point there. So each face falls into pieces, each with all of its corners near
/// one triangle, and as the distance to a triangle is convex, no point of the piece is farther.
/// That bounds the way from the reference to the surface. The map is continuous, and where it is of
/// degree one it reaches every point of the surface, so that the same number bounds the way back.
/// From closed components where it is not, or where that cannot be told, the way back is measured
/// triangle by triangle; see uncovered.h. Nothing is projected and nothing is sampled; folds of the
/// reference do no harm.
///
/// Where a face has no such pieces within `expected` voxels, another owner is sought for one of its
/// corners. If there is none, the face is halved until a bound of the way forth is tight, and
/// nothing is said of where it goes: the way back is measured from the triangles that its edges
/// pass, and from those that they cut off from the rest. The sums are in single precision: a
/// millionth of the coordinates is left to rounding.
///
/// Cost: about 60 ns a reference vertex, and some milliseconds for each face that is halved.
[[nodiscard]] Certificate certify(const Surface& surface, const ReferenceMesh& reference,
                                  float expected, base::Job& job);

}  // namespace tufa::reduce
