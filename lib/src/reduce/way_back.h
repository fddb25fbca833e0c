#pragma once

#include <span>
#include <vector>

#include "reduce/corners.h"
#include "reduce/halving.h"
#include "reduce/measured.h"
#include "reduce/uncovered.h"

namespace tufa::reduce {

/// Bounds the way from triangles of the surface to the reference, where the map of certify() may
/// not reach them.
class WayBack {
 public:
  /// `owner`: for each reference vertex the triangle that answers for it, or kNone. `gaps`: all
  /// that are to be measured.
  WayBack(const Surface& s, const ReferenceMesh& reference, const CornersOfVertices& corners,
          std::span<const Index> owner, std::span<const Gap> gaps, const Limits& limits,
          RegionMaxima& regions);

  /// From what of a triangle lies in a sphere about some faces, to all faces nearby at reference
  /// vertices of the triangles around. From the whole triangle, if that is less. All gaps are of
  /// one triangle. One sphere, as what is outside a convex part of a triangle is connected to its
  /// corners, of which uncovered.h tells.
  void fromGaps(std::span<const Gap> gaps, Measured& measured) const;

 private:
  void fromGap(const Gap& gap, const Sphere& about, Measured& measured) const;
  template <class F>
  void forVerticesNear(const Gap& gap, const Sphere& about, F&& f) const;
  [[nodiscard]] std::vector<Index> allFacesNear(const Gap& gap, const Sphere& about) const;
  [[nodiscard]] std::vector<Index> someFacesNear(const Gap& gap, const Sphere& about) const;

  const Surface& s_;
  const ReferenceMesh& reference_;
  const CornersOfVertices& corners_;
  const Limits& limits_;
  RegionMaxima& regions_;
  std::vector<Index> place_;               // in owned_, of triangles around gaps; else kNone
  std::vector<std::vector<Index>> owned_;  // the reference vertices of each
};

/// From a whole triangle to faces among which the nearest ones are.
void measureWayBack(const Surface& s, const ReferenceMesh& reference, const Limits& limits,
                    RegionMaxima& regions, Index triangle, const FacesNear& faces,
                    Measured& measured);

}  // namespace tufa::reduce
