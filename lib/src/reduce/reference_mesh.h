#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/job.h"
#include "base/shared_array.h"
#include "base/triangle_array.h"
#include "reduce/corners.h"
#include "reduce/surface.h"
#include "reduce/triangles.h"

namespace tufa::reduce {

/// The mesh that distances are measured to, the uniform one or a proxy. Only what is held changes.
class ReferenceMesh {
 public:
  /// The mesh of a surface as makeSurface() gives it. `scales`: see scaleAt(); one for each vertex,
  /// or none.
  ReferenceMesh(const Surface& input, std::vector<float> scales, base::Job& job);

  [[nodiscard]] const base::SharedArray<Vec3f>& positions() const { return positions_; }
  [[nodiscard]] const base::TriangleArray& faces() const { return faces_; }
  [[nodiscard]] Index faceCount() const { return static_cast<Index>(faces_.size()); }
  [[nodiscard]] std::array<Index, 3> vertices(Index face) const { return faces_[face].vertices; }
  /// One of a vertex's corners, or kNone.
  [[nodiscard]] Index cornerOf(Index vertex) const { return cornerOf_[vertex]; }
  /// Whether what guards allow differs from place to place.
  [[nodiscard]] bool isScaled() const { return hasScales() || heldShare_ < 1; }
  /// What the tolerance is multiplied with at a vertex for the guards.
  [[nodiscard]] float scaleAt(Index vertex) const {
    if ((marks_[vertex] & kFrozen) != 0) return 0;
    return promisedScaleAt(vertex) * ((marks_[vertex] & kHeld) != 0 ? heldShare_ : 1);
  }
  /// In place of those before.
  void setScales(std::vector<float> scales) { scales_ = std::move(scales); }
  /// Whether the tolerance that is promised differs from place to place.
  [[nodiscard]] bool hasScales() const { return !scales_.empty(); }
  /// What it is multiplied with at a vertex.
  [[nodiscard]] float promisedScaleAt(Index vertex) const {
    return hasScales() ? scales_[vertex] : 1;
  }
  /// Holds faces near others: within `radius` voxels of them, over connected faces, all vertices
  /// count as rough, and guards allow a share of the tolerance; 0, where they are held already. Of
  /// faces within an eighth of the radius of each other one stands for all.
  void hold(std::span<const Index> faces, float radius, float share, base::Job& job);
  void releaseAll();
  /// Whether a vertex of a face is held.
  [[nodiscard]] bool isHeld(Index face) const {
    const auto v = vertices(face);
    return ((marks_[v[0]] | marks_[v[1]] | marks_[v[2]]) & kHeld) != 0;
  }
  /// Whether a vertex of a face is rough.
  [[nodiscard]] bool isRoughFace(Index face) const {
    const auto v = vertices(face);
    return ((marks_[v[0]] | marks_[v[1]] | marks_[v[2]]) & kAnyRough) != 0;
  }
  /// Whether a face at the vertex turns by more than 49 degrees from their common axis, so that
  /// what is seen along one axis may not be all; or whether ways are required there.
  [[nodiscard]] bool isRough(Index vertex) const { return (marks_[vertex] & kAnyRough) != 0; }
  /// Whether the surface bends both ways at the vertex, see VertexFlag.
  [[nodiscard]] bool isBent(Index vertex) const { return (marks_[vertex] & kIsBent) != 0; }
  /// From now on faces at these vertices are to have ways to the surface, as the certificate asks
  /// for them: where sections lead elsewhere, nothing less is a bound. The vertices are rough then.
  void requireWays(std::span<const Index> vertices) {
    for (const Index v : vertices) marks_[v] |= kWays;
  }
  [[nodiscard]] bool requiresWays(Index vertex) const { return (marks_[vertex] & kWays) != 0; }
  [[nodiscard]] const Vec3f& corner(Index face, std::size_t i) const {
    return positions_[faces_.vertex(face, i)];
  }
  [[nodiscard]] std::array<Vec3f, 3> cornersOf(Index face) const {
    return {corner(face, 0), corner(face, 1), corner(face, 2)};
  }
  /// Distance from p to a face.
  [[nodiscard]] float distance(Index face, Vec3f p) const {
    return std::sqrt(
        squaredDistanceToTriangle(p, corner(face, 0), corner(face, 1), corner(face, 2)));
  }
  /// Calls f(face) for the faces around a vertex, to a border at most, until f returns false;
  /// returns whether it never did.
  template <class F>
  bool allAround(Index vertex, F&& f) const {
    const Index first = cornerOf_[vertex];
    for (Index c = first; c != kNone;) {
      if (!f(c / 3)) return false;
      c = around(c);
      if (c == first) break;
    }
    return true;
  }
  /// The corner at the same vertex of the next face counter-clockwise, or kNone at a border.
  [[nodiscard]] Index around(Index c) const {
    const Index across = opposite(nextCorner(c));
    return across == kNone ? kNone : nextCorner(across);
  }

  /// The face across the edge from a face's corner i to the next one, or kNone.
  [[nodiscard]] Index faceAcross(Index face, std::size_t i) const {
    const Index c = opposite(3 * face + static_cast<Index>((i + 2) % 3));
    return c == kNone ? kNone : c / 3;
  }

  [[nodiscard]] bool isAtBorder(Index vertex) const {
    const Index first = cornerOf_[vertex];
    Index c = first;
    while (c != kNone && (c = around(c)) != first) {
    }
    return c == kNone;
  }

  /// Walks from face `start` to the face that the line through p along `axis` passes. kNone if the
  /// way ends at a border, takes more than `steps` faces, or ends at a face that looks against the
  /// axis.
  [[nodiscard]] Index locate(Index start, Vec3f p, Vec3f axis, int steps = 64) const;

  /// How follow() walks.
  struct Section {
    Vec3f start;  ///< a point; the line through it along the axis passes the first face
    Vec3f along;  ///< to the end
    Vec3f axis;
    /// Whether the end is a plane across `along`, not one that holds the axis: where the surface
    /// may stand upright, as beside a star that is no graph.
    bool steep = false;
  };

  /// Where a section passes its end.
  struct Arrival {
    Index face = kNone;
    Vec3f at;  ///< seen from the start
    explicit operator bool() const { return face != kNone; }
  };

  /// Follows the section of the mesh with the plane through `start` that `along` and `axis` span,
  /// from face `first` to where it passes the end. visit(face, m, right, left) is called where it
  /// leaves a face across the edge from right to left, at m, all as seen from the start; the walk
  /// ends when that returns false. Returns where the end was reached, if it was.
  ///
  /// The section is followed by the sides of the edges' ends alone, so that it needs no graph: it
  /// goes up and down walls, over creases, and past its own start if the surface does.
  template <class Visit>
  Arrival follow(Index first, const Section& section, Visit&& visit) const {
    const Vec3f side = cross(section.axis, section.along);  // positive on the left
    const Vec3f forward = section.steep
                              ? section.along
                              : section.along - section.axis * dot(section.along, section.axis);
    const float end = dot(forward, section.along);
    Vec3f q[3];
    float s[3];
    int out = -1;  // the section leaves through the edge opposite this corner
    const auto enter = [&](Index f) {
      for (int i = 0; i < 3; ++i) {
        q[i] = corner(f, static_cast<std::size_t>(i)) - section.start, s[i] = dot(q[i], side);
      }
      for (int i = 0; i < 3; ++i) {
        if (s[(i + 1) % 3] <= 0 && s[(i + 2) % 3] > 0) out = i;
      }
      return out >= 0;
    };
    Index face = first;
    const auto tryFace = [&](Index f) {
      if (f != kNone && out < 0 && enter(f)) face = f;
    };
    if (!enter(first)) {
      // A section that starts at a vertex of that face, or along an edge, may begin in another face
      // there.
      const float beside = kBeside * length(side);
      const bool isAt[] = {squaredLength(q[0]) == 0, squaredLength(q[1]) == 0,
                           squaredLength(q[2]) == 0};
      const bool isBeside[] = {std::abs(s[0]) <= beside, std::abs(s[1]) <= beside,
                               std::abs(s[2]) <= beside};
      for (std::size_t i = 0; i < 3; ++i) {
        if (isAt[i]) {
          (void)allAround(vertices(first)[i], [&](Index f) { return tryFace(f), out < 0; });
        } else if (isBeside[(i + 1) % 3] && isBeside[(i + 2) % 3]) {
          const Index c = opposite(3 * first + static_cast<Index>(i));
          tryFace(c == kNone ? kNone : c / 3);
        }
      }
    }
    if (out < 0) return {};
    Vec3f before;
    Vec3f right = q[(out + 1) % 3], left = q[(out + 2) % 3];
    float sr = s[(out + 1) % 3], sl = s[(out + 2) % 3];
    for (int step = 0; step < kMostSteps; ++step) {
      const float share = sr / (sr - sl);
      const Vec3f m = right + (left - right) * share;
      if (const float way = dot(m, forward); way >= end) {
        const float over = way - end, length = way - dot(before, forward);
        return {face, length > over ? m - (m - before) * (over / length) : m};
      }
      if (!visit(face, m, right, left)) return {};
      before = m;
      const Index c = opposite(3 * face + static_cast<Index>(out));
      if (c == kNone) return {};
      face = c / 3;
      const int at = static_cast<int>(c - 3 * face);
      prefetchAcross(at == 2 ? c - 2 : c + 1);
      prefetchAcross(at == 0 ? c + 2 : c - 1);
      const Vec3f w = corner(face, static_cast<std::size_t>(at)) - section.start;
      const float sw = dot(w, side);
      // The edge from right to left is opposite c, turned round: right comes after c's successor.
      if (sw > 0) {
        left = w, sl = sw, out = at == 2 ? 0 : at + 1;
      } else {
        right = w, sr = sw, out = at == 0 ? 2 : at - 1;
      }
    }
    return {};
  }

 private:
  // The corner across the edge of a corner, or kNone. Of quads, whose halves meet at corners 1 and
  // 5 of their six, only those across the four other edges are stored.
  [[nodiscard]] Index opposite(Index c) const {
    if (!faces_.areHalves()) return opposite_[c];
    const Index quad = c / 6, i = c - 6 * quad;
    if (i == 1) return c + 4;
    if (i == 5) return c - 4;
    return opposite_[4 * quad + (i == 0 ? 0 : i - 1)];
  }
  void setOpposite(Index c, Index other);

  // Asks for a face that a walk may enter next while the position that decides it is read.
  void prefetchAcross(Index c) const {
    const Index across = opposite(c);
    faces_.prefetch(across == kNone ? 0 : across / 3);
  }

  static constexpr float kBeside = 1e-4f;  ///< voxels from a section, for an edge along it
  static constexpr int kMostSteps = 2000;
  static constexpr std::uint8_t kRough = 1, kHeld = 2, kFrozen = 4, kIsBent = 8, kWays = 16;
  static constexpr std::uint8_t kAnyRough = kRough | kHeld | kFrozen | kWays;

  base::SharedArray<Vec3f> positions_;
  base::TriangleArray faces_;
  std::vector<Index> opposite_;  ///< of each corner, or of four of a quad's, see opposite()
  std::vector<Index> cornerOf_;
  std::vector<std::uint8_t> marks_;  ///< of these
  std::vector<float> scales_;
  float heldShare_ = 1;
};

}  // namespace tufa::reduce
