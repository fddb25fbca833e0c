#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/direction.h"
#include "base/job.h"
#include "base/shared_array.h"
#include "base/triangle_array.h"
#include "reduce/corners.h"
#include "reduce/lines.h"

namespace tufa::reduce {

enum VertexFlag : std::uint8_t {
  kNarrow = 1,  ///< other surface is near: intersections are tested explicitly
  kBorder = 2,  ///< on an open border: stays
  /// In the input a triangle turned by more than 49 degrees from the common axis, or had no area.
  kSteep = 4,
  kBent = 8,  ///< in the input the surface bends both ways, as on a ball or a saddle
};

class ReferenceMesh;

/// The mesh between phases: arrays without gaps.
struct Surface {
  /// Nothing is reduced yet: the triangles are those of the reference, the owner of each reference
  /// vertex is one of those at it, and `source` and `face` are empty. So that a fine mesh takes
  /// less memory.
  bool isWhole = false;

  // For each vertex.
  base::SharedArray<Vec3f> position;
  std::vector<base::Direction> axis;  ///< all triangles at the vertex face it; may be none
  std::vector<std::uint8_t> flags;    ///< of VertexFlag
  std::vector<Index> source;          ///< the input's vertex that it still is, or kNone
  std::vector<Index> face;            ///< of the reference, at the vertex seen along its axis

  base::TriangleArray triangles;
  /// For each reference vertex its owner: the triangle that answers for it. kNone for those without
  /// faces.
  std::vector<Index> owner;

  // Empty without regions.
  base::SharedArray<Index> region;  ///< of each triangle
  std::vector<LineKind> lineKind;   ///< of each vertex
  // Empty before the first step of LineMode::Alone: for each vertex, and for each name of a vertex
  // where it has gone, else itself, and the plane of the line that it went for.
  std::vector<LineStep> lineStep;
  std::vector<Index> into;
  std::vector<Index> intoPlane;
  // In such a step: for each triangle the plane for whose sake it has changed, kNone for none; and
  // all that have changed, as they were.
  std::vector<Index> changeOf;
  std::vector<Form> oldForms;
  /// Edges of the input inside a region between vertices of lines in one plane, as keys of
  /// chordKey(), sorted: they may never become edges of lines.
  std::vector<std::uint64_t> chords;
  // See Regions.
  std::vector<Vec3f> planeNormals;
  std::function<LinePlanes(Index source)> planesOf;
  std::function<bool(Index region, Index plane, Vec3f place, Vec3f a, Vec3f b)> mayHold;

  [[nodiscard]] static std::uint64_t chordKey(Index a, Index b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }
  [[nodiscard]] bool isChord(Index a, Index b) const {
    return std::binary_search(chords.begin(), chords.end(), chordKey(a, b));
  }
  [[nodiscard]] Index sourceOf(Index v) const { return isWhole ? v : source[v]; }
  [[nodiscard]] bool hasLines() const { return !lineKind.empty(); }
  [[nodiscard]] bool isOnLine(Index v) const { return hasLines() && lineKind[v] != LineKind::Off; }
  [[nodiscard]] bool hasAxis(Index v) const { return !axis[v].isNone(); }
  [[nodiscard]] const Vec3f& corner(Index triangle, std::size_t i) const {
    return position[triangles.vertex(triangle, i)];
  }
};

/// A surface of these positions and triangles, with axes, and flags of borders and steep stars.
/// Vertices without an axis, and those beside them, are narrow.
[[nodiscard]] Surface makeSurface(base::SharedArray<Vec3f> positions, base::TriangleArray triangles,
                                  base::Job& job);
/// The face of the reference below a vertex, or kNone.
[[nodiscard]] Index faceOf(const Surface& surface, const ReferenceMesh& reference, Index vertex);

/// Gives every reference vertex an owner at the vertex that stands for it, and every vertex a face
/// of the reference. `standsFor`: for each reference vertex a vertex; empty if the two meshes are
/// the same, and the surface whole.
void locateAll(Surface& surface, const ReferenceMesh& reference, std::span<const Index> standsFor,
               base::Job& job);

/// Divides a surface that is as it came in into regions, see Regions. Borders' ends are ends of
/// lines.
void setRegions(Surface& surface, Regions regions, base::Job& job);

/// What a phase has done to a surface.
struct SurfaceChanges {
  struct Moved {
    Index vertex;
    Vec3f to;
    Index face;  ///< of the reference, there
  };
  struct Changed {
    Index triangle;
    Triangle now;
  };
  std::vector<Moved> moved;
  std::vector<Changed> changed;
};

/// Makes changes, removes the triangles marked in `dead` and the vertices without triangles; the
/// others keep their order.
void apply(Surface& surface, const ReferenceMesh& reference,
           const std::vector<SurfaceChanges>& changes, const std::vector<std::uint8_t>& dead,
           base::Job& job);

}  // namespace tufa::reduce
