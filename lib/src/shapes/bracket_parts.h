#pragma once

#include <array>
#include <vector>

#include "shapes/distance_field.h"

namespace tufa::shapes::bracket {

// The solid in its own frame. The profile lies in x and z, the plates are extruded along y.
inline constexpr double kBack = -0.9;  ///< x of the upright's back
inline constexpr double kUprightFront = -0.65;
inline constexpr double kFront = 0.9;  ///< x of the base plate's tip
inline constexpr double kLow = -0.7;   ///< z of the base plate's underside
inline constexpr double kBaseTop = -0.45;
inline constexpr double kHigh = 0.7;       ///< z of the upright's top
inline constexpr double kHalfDepth = 0.5;  ///< of the plates, along y
inline constexpr double kHalfRib = 0.1;    ///< of the rib, along y
inline constexpr double kRibEnd = 0.15;    ///< x where the rib meets the base plate
inline constexpr double kRibTop = 0.35;    ///< z where it meets the upright: a slope of 45 degrees
inline constexpr double kReach = 1.25;     ///< no point of the solid is further from the origin

struct Segment {
  Vec3 a, b;
  [[nodiscard]] double distance(const Vec3& p) const;
};

/// A hole's wall: a cylinder between the two rims.
struct Cylinder {
  Vec3 start;  ///< centre of the first rim
  Vec3 axis;   ///< unit length, towards the other rim
  double radius = 0;
  double height = 0;
  [[nodiscard]] double axisDistance(const Vec3& p) const;
  [[nodiscard]] double distance(const Vec3& p) const;
};

/// A planar polygon with round holes.
struct Face {
  std::vector<Vec3> corners;
  std::vector<Cylinder> holes;  ///< those that pass through it
  Vec3 normal, u, v;            ///< an orthonormal frame
  /// Whether p lies above or below the face itself, rather than beyond its outline or over a hole.
  [[nodiscard]] bool covers(const Vec3& p) const;
  [[nodiscard]] double planeDistance(const Vec3& p) const;
};

/// Patches of the boundary; all of them, or those that matter near some place.
struct Parts {
  std::vector<Face> faces;
  std::vector<Segment> edges;
  std::vector<Cylinder> holes;

  /// The whole boundary of the bracket.
  static const Parts& get();

  /// Least distance to any patch. The outline of each face is among the edges and the holes' rims.
  [[nodiscard]] double boundaryDistance(const Vec3& p) const;

  /// The patches that can be nearest to some point of a ball.
  [[nodiscard]] Parts near(const Vec3& center, double radius) const;
};

}  // namespace tufa::shapes::bracket
