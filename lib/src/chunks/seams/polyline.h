#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/vec3.h"
#include "chunks/seams/seams.h"
#include "grid/affine.h"

namespace tufa::chunks {

/// For each seam vertex the one that stands for it: what one level makes of the seams.
using SeamPolylines = std::vector<SeamIndex>;

/// For each arc of a closed curve the quadrant of the least square of the octree that holds all of
/// them; empty if they are in one cell. A cluster's cell lies in one quadrant.
[[nodiscard]] std::vector<std::uint8_t> quadrantsOf(const Seams& seams, const SeamCurve& curve);

/// Vertices of lines at which strips are not sound; sorted.
struct LineFaults {
  std::vector<SeamIndex> meeting;  ///< of triangles that meet others
  std::vector<SeamIndex> folded;   ///< of folded triangles
};
/// Finds the faults of lines of one face; asked again with other lines.
using FaceValidation = std::function<LineFaults(const SeamPolylines& lines)>;
/// Begins a trial of the curves `begin` to `end`, which are those of one face.
using PolylineValidation = std::function<FaceValidation(std::size_t begin, std::size_t end)>;

/// Simplifies the curves of all seams, each to a polyline on its face through some of its arcs'
/// vertices. No vertex that is left out is further from it than `allowed` says, in world units.
///
/// The arcs that one vertex stands for are contiguous. Between two chunk edges at least one vertex
/// is left, of a closed curve three, and no run of arcs and no cluster of any level have more than
/// one stretch in common; so whatever clusters the chunks on both sides have, the strip between
/// clusters and polyline has no edge twice. Polylines on one face do not cross, unless their arcs
/// do.
///
/// What becomes of a curve depends on what lies on its face alone, and not on the order of
/// anything.
///
/// Polylines are made finer at vertices that `trial` finds faults at, see StripTrial, until there
/// are none or nothing can be made finer.
[[nodiscard]] SeamPolylines simplifySeams(
    const Seams& seams, const grid::Affine& affine,
    const std::function<double(const Vec3& latticePoint)>& budget,
    const PolylineValidation& validation = nullptr);

}  // namespace tufa::chunks
