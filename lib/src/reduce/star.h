#pragma once

#include "reduce/triangles.h"

namespace tufa::reduce {

// What a star (the triangles around one vertex) must be, so that it has neither a fold nor a
// crossing of its own. There are two proofs:
//
// 1. All of its triangles face one axis (cosine at least kLeastCosine), and seen along it they go
//    around the vertex once. Then the star is the graph of a function over a plane.
// 2. Where no axis serves, at acute creases and corners: triangles with a common apex meet
//    elsewhere than in a common edge if and only if their arcs on the unit sphere around the apex
//    meet. So the link must be a simple polygon on the sphere.

/// The least cosine between a triangle's normal and the axes of its corners: 78 degrees.
inline constexpr float kLeastCosine = 0.2f;
/// Edges turn by less than this where they may: the cosine of 143 degrees.
inline constexpr float kFoldCosine = -0.8f;
/// And by less than this, 170 degrees, where the star was as sharp before, as on a thin wedge.
inline constexpr float kSharpestCosine = -0.985f;
/// The squared sine of 1 degree: no new sliver is as sharp.
inline constexpr float kWorstSine2 = 3e-4f;
/// Square of a cross product of two edges: faces of less than 0.02 square voxels make no fold.
inline constexpr float kTinyFace2 = 0.0016f;
/// Where an operation takes more slivers than it makes, its sharpest angle may be smaller by this
/// in its squared sine, to a third of the one before.
inline constexpr float kSharper2 = 0.1f;
/// Most corners of a link that is looked at.
inline constexpr int kMostRing = 48;

/// A direction along which all unit normals have a good part: their mean, pulled towards the worst
/// ones. `leastCosine` is set to the least part.
[[nodiscard]] Vec3f commonAxis(const Vec3f* normals, int count, float& leastCosine);

/// Whether a polygon, given as seen from the vertex, goes once around the axis. All of its steps
/// must turn counter-clockwise.
[[nodiscard]] bool windsOnce(const Vec3f* to, int count, Vec3f axis);

/// Whether the arcs from s to t and from x to y, all unit vectors, keep apart by 1e-4 rad at least,
/// as seen by the planes through the apex that could part them.
[[nodiscard]] bool arcsPart(Vec3f s, Vec3f t, Vec3f x, Vec3f y);

/// Whether the spherical polygon of these unit vectors is simple, by all pairs of arcs of which one
/// has an end in [first, last].
[[nodiscard]] bool linkIsSimple(const Vec3f* directions, int count, int first, int last);

}  // namespace tufa::reduce
