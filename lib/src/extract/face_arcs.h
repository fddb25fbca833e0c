#pragma once

#include <tufa/mesh.h>

#include <array>
#include <optional>

#include "uniform/case_table.h"

// Marching squares on one face of a cell. Both cells at the face see the same, to the bit: places
// are counted from the lowest corner of the face, along the two other axes in rising order.

namespace tufa::extraction {

using FacePoint = std::array<double, 2>;

/// A piece of the contour of a face: from the edge by which a walk around the face enters the
/// inside to one by which it leaves, with the inside on its right. Edges are places in
/// uniform::kFaceEdges.
struct FaceArc {
  int from = 0;
  int to = 0;
};

/// The contour of a face. Of two arcs the first one has edge 0.
struct FaceArcs {
  std::array<FaceArc, 2> arcs{};
  int count = 0;
};

/// The arcs of a face. `joined`: whether the inside corners of an ambiguous one are.
[[nodiscard]] FaceArcs arcsOf(uniform::CornerMask mask, int face, bool joined);

/// Which of the arcs of a face has this edge of the cell.
[[nodiscard]] inline int arcWith(uniform::CornerMask mask, int face, int edge, int otherEdge) {
  const int first = uniform::kFaceEdges[face][0];
  return uniform::isAmbiguous(mask, face) && edge != first && otherEdge != first ? 1 : 0;
}

/// A crossing on an edge of a face.
struct FaceCrossing {
  FacePoint at{};
  FacePoint plane{};  ///< outward: of the tangent plane's covector what is in the face
  Normal normal{};
};

/// Whether an arc is sharp: the normals at its ends differ by more than this cosine tells.
[[nodiscard]] bool isSharp(const FaceCrossing& from, const FaceCrossing& to, double leastCosine);

/// Whether a point is in the face, not too near to its edges.
[[nodiscard]] bool isInFace(const FacePoint& point);

/// Where the tangent lines at both ends of an arc meet, if the arc is sharp and they do so in the
/// face, ahead of its start and before its end.
[[nodiscard]] std::optional<FacePoint> sharpPoint(const FaceCrossing& from, const FaceCrossing& to,
                                                  double leastCosine);

/// Whether an ambiguous face joins its inside corners: the way in which its two arcs, with their
/// sharp points, do not intersect; `otherwise`, if that holds for both or for none. `crossings` are
/// those of its four edges.
[[nodiscard]] bool joinsInside(uniform::CornerMask mask, int face,
                               const std::array<FaceCrossing, 4>& crossings, double leastCosine,
                               bool otherwise);

}  // namespace tufa::extraction
