#pragma once

#include <tufa/mesh.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/vec3.h"

namespace tufa::uniform {

/// The smooth sheets of the surface that meet at one vertex on a crease (2) or corner (3).
struct MeetingSheets {
  std::uint8_t count = 0;
  std::array<Normal, 3> normals{};  ///< outward, world space
};

/// The smooth sheets of the surface that each vertex of a mesh lies on.
///
/// Almost every vertex lies on one, whose normal is the vertex's own; only vertices on creases and
/// corners have an entry. Cost: two bytes a vertex; where there are creases four more, and the
/// entries.
class VertexSheets {
 public:
  /// How a vertex lies to creases.
  enum class Kind : std::uint8_t {
    Smooth,   ///< no kink of the field was seen
    Near,     ///< on one sheet, with a crease nearby
    Meeting,  ///< on a crease or corner; sheets() tells the sheets
    Unknown,  ///< on several sheets that could not be told apart
  };

  explicit VertexSheets(std::size_t vertices = 0);

  [[nodiscard]] Kind kind(VertexIndex vertex) const { return kinds_[vertex]; }
  [[nodiscard]] bool isSharp(VertexIndex vertex) const { return kinds_[vertex] >= Kind::Meeting; }
  /// Sets the kinds of consecutive vertices. May be called from several threads for vertices of
  /// their own.
  void setKinds(std::size_t first, const std::vector<Kind>& kinds) {
    std::copy(kinds.begin(), kinds.end(), kinds_.begin() + static_cast<std::ptrdiff_t>(first));
  }
  /// Whether the vertex may lie out of its cell.
  [[nodiscard]] bool isOutOfCell(VertexIndex vertex) const { return outOfCell_[vertex] != 0; }
  /// May be called from several threads.
  void setOutOfCell(VertexIndex vertex) { outOfCell_[vertex] = 1; }
  void setMeeting(VertexIndex vertex, const MeetingSheets& sheets);
  /// Takes back a place at a crease: the vertex is in its cell again, and on no known crease.
  void withdraw(VertexIndex vertex) {
    outOfCell_[vertex] = 0;
    if (isSharp(vertex)) kinds_[vertex] = Kind::Unknown;
  }
  /// The vertex has left its cell for a place on no crease.
  void moveOffCrease(VertexIndex vertex) {
    outOfCell_[vertex] = 1;
    kinds_[vertex] = Kind::Near;
  }
  /// The sheets of a vertex; count 0 if they are unknown.
  [[nodiscard]] MeetingSheets sheets(const Mesh& mesh, VertexIndex vertex) const;
  /// Number of vertices on creases and corners.
  [[nodiscard]] std::size_t sharpCount() const;

 private:
  std::vector<Kind> kinds_;
  std::vector<std::uint8_t> outOfCell_;  // bytes, as threads set their own
  std::vector<std::uint32_t> entryOf_;   // of vertices on creases, counted from 1; empty: none is
  std::vector<MeetingSheets> entries_;
};

/// The sheets around one quad: those of its corners, equal ones merged.
class QuadSheets {
 public:
  static constexpr int kMost = 12;  ///< three for each corner

  QuadSheets(const Mesh& mesh, const VertexSheets& sheets, const Quad& quad);

  /// Whether all vertices of a quad certainly lie on one sheet: a quick answer for most.
  [[nodiscard]] static bool isOneSheet(const Mesh& mesh, const VertexSheets& sheets,
                                       const Quad& quad);

  /// Whether both triangles of the split at diagonal 0-2 (or 1-3) lie on one sheet each. A triangle
  /// that does not cuts off a crease or corner.
  [[nodiscard]] bool fits(bool secondDiagonal) const;
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const Vec3& normal(int side) const { return normals_[side]; }
  /// Whether corner `corner` of the quad lies on sheet `side`.
  [[nodiscard]] bool lies(int corner, int side) const {
    return ((masks_[corner] >> side) & 1) != 0;
  }
  /// Whether the sheets of the corner are known.
  [[nodiscard]] bool known(int corner) const { return masks_[corner] != kAll; }

 private:
  static constexpr unsigned kAll = ~0U;
  std::array<unsigned, 4> masks_{};
  std::array<Vec3, kMost> normals_;
  int count_ = 0;
};

}  // namespace tufa::uniform
