#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/shared_array.h"
#include "reduce/corners.h"
#include "reduce/triangles.h"

namespace tufa::reduce {

/// What a vertex is to the lines of a surface, the edges between triangles of different regions.
enum class LineKind : std::uint8_t {
  Off,  ///< on no line: may go anywhere in its region, or into any neighbour
  On,   ///< inside a line: may go into a neighbour on its line
  End,  ///< where lines end or meet, or on several planes: stays
};

/// The planes of lines that a vertex lies on, kNone where there are fewer than three.
using LinePlanes = std::array<Index, 3>;
inline constexpr LinePlanes kNoPlanes = {kNone, kNone, kNone};

[[nodiscard]] inline int commonPlanes(const LinePlanes& some, const LinePlanes& others) {
  int count = 0;
  for (const Index plane : some) {
    for (const Index other : others) count += plane != kNone && plane == other;
  }
  return count;
}

/// A vertex in a step of LineMode::Alone.
struct LineStep {
  /// The plane whose vertices' going has changed a triangle at this vertex, kNone for none,
  /// kSeveral if it may not go any more.
  Index change = kNone;
  Index name = kNone;     ///< its number when the last such step began
  bool isBeside = false;  ///< off a line, and beside one then

  static constexpr Index kSeveral = kNone - 1;

  void addChange(Index plane) { change = change == kNone || change == plane ? plane : kSeveral; }
  /// Whether it may go without changing triangles in a second plane.
  [[nodiscard]] bool mayChange(Index plane) const { return change == kNone || change == plane; }
};

/// A vertex as lines see it.
struct LineVertex : LineStep {
  LineKind kind = LineKind::Off;
  LinePlanes planes = kNoPlanes;
};

/// A triangle in a step of LineMode::Alone, as it was when that began or as it is.
struct Form {
  std::array<Vec3f, 3> corners;
  std::array<Index, 3> names;  ///< of its vertices, see LineStep
  Index region;
  Index plane;  ///< for whose sake it changes
};

/// How lines are reduced. Lines lie in planes. Wherever they are reduced, a vertex of a line goes
/// into a neighbour on its line under all guards, which may move in its plane if Regions::normals
/// are given.
enum class LineMode : std::uint8_t {
  Free,   ///< together with the rest
  Alone,  ///< and beside them only what goes into a neighbour that stays where it is
  Held    ///< not at all
};

/// A surface that is divided into regions, each on its own side of planes.
///
/// Regions meet in planes only, and no edge inside a region is made between two vertices of lines
/// in one plane. So a region touches the planes around it in its lines alone, and is apart from its
/// neighbours whatever is done inside.
struct Regions {
  base::SharedArray<Index> ofTriangle;
  /// Of a vertex of the input that is on a line. Called from several threads.
  std::function<LinePlanes(Index vertex)> planesOf;
  /// Of planes by their numbers, unit. Given, vertices of lines may move in their plane as they
  /// take in others; where lines are reduced alone, others of their line only.
  std::vector<Vec3f> normals;
  /// Whether a vertex of a region that was at `a` or `b` may be at a place. `plane`: in which it
  /// is, if it is on a line, else kNone. Called from several threads.
  std::function<bool(Index region, Index plane, Vec3f place, Vec3f a, Vec3f b)> mayHold;
};

}  // namespace tufa::reduce
