#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/vec3.h"
#include "chunks/seams/seams.h"
#include "grid/affine.h"

namespace tufa::chunks {

/// For each seam vertex the one that stands for it at one LOD: the boundary polylines of that LOD.
using SeamPolylines = std::vector<SeamIndex>;

/// For each arc of a closed curve its quadrant in the least octree square that holds the whole
/// curve; empty if all are in one cell. A cluster's cell lies in one quadrant, unless it holds the
/// whole curve.
[[nodiscard]] std::vector<std::uint8_t> quadrantsOf(const Seams& seams, const SeamCurve& curve);

/// Vertices of polylines at which strips have faults; sorted.
struct LineFaults {
  std::vector<SeamIndex> meeting;  ///< of triangles that intersect others
  std::vector<SeamIndex> folded;   ///< of folded triangles
};
/// Finds the faults of the polylines of one face; called again as they are refined.
using FaceValidation = std::function<LineFaults(const SeamPolylines& lines)>;
/// Begins the validation of the curves `begin` to `end`, which are those of one face.
using PolylineValidation = std::function<FaceValidation(std::size_t begin, std::size_t end)>;

/// Simplifies the curves of all seams, each to a polyline on its face through some of its arcs'
/// vertices. No vertex that is left out is farther from it than `budget` tells, world units.
///
/// The arcs that one vertex stands for, its run, are contiguous. Between two chunk edges at least
/// one vertex is left, of a closed curve three, and no run and cluster of any octree level have
/// more than one stretch in common. So whatever clusters the chunks on both sides have, the strip
/// between clusters and polyline uses no edge twice. Polylines on one face do not cross, unless
/// their arcs do.
///
/// A polyline depends on what lies on its face alone and not on the order of anything, as both
/// chunks must choose the same without seeing each other. Where `validation` finds faults, see
/// StripValidation, polylines are refined until there are none or nothing can be refined. Cost:
/// splitting at the farthest vertex (Douglas and Peucker 1973), n log n in the usual case.
[[nodiscard]] SeamPolylines simplifySeams(
    const Seams& seams, const grid::Affine& affine,
    const std::function<double(const Vec3& latticePoint)>& budget,
    const PolylineValidation& validation = nullptr);

}  // namespace tufa::chunks
