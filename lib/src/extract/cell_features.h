#pragma once

#include <tufa/mesh.h>

#include <array>
#include <cstdint>

#include "base/bits.h"
#include "extract/derive_cube.h"

namespace tufa::extraction {

/// The face that holds two edges, as consecutive crossings of a loop are.
inline constexpr auto kFaceOf = [] {
  std::array<std::array<std::int8_t, kEdges>, kEdges> faces{};
  for (int face = 0; face < kFaces; ++face) {
    for (const int a : uniform::kFaceEdges[face]) {
      for (const int b : uniform::kFaceEdges[face]) faces[a][b] = static_cast<std::int8_t>(face);
    }
  }
  return faces;
}();

/// A lattice edge on a face across an axis, as the cell beyond that face numbers it.
inline constexpr auto kBeyond = [] {
  std::array<std::array<std::int8_t, 3>, kEdges> beyond{};
  for (int edge = 0; edge < kEdges; ++edge) {
    const auto [lower, upper] = uniform::edgeCorners(edge);
    for (int axis = 0; axis < 3; ++axis) {
      const int step = 4 >> axis;
      beyond[edge][axis] =
          static_cast<std::int8_t>(uniform::edgeBetween(lower ^ step, upper ^ step));
    }
  }
  return beyond;
}();

/// A vertex on a crease or corner.
struct Feature {
  Position position;
  Normal normal;
};

/// Which parts of a cell, of up to eight, have a feature, and the number of the first one: of a
/// vertex, or of tangent planes.
struct CellFeatures {
  VertexIndex first = 0;
  std::uint8_t parts = 0;

  void add(int part) { parts = static_cast<std::uint8_t>(parts | 1 << part); }
  [[nodiscard]] bool has(int part) const { return ((parts >> part) & 1) != 0; }
  [[nodiscard]] VertexIndex of(int part) const {
    return first + static_cast<VertexIndex>(base::countBits(parts & base::bitsBelow(part)));
  }
};

/// Whether a triangle of a case belongs to a loop without a feature. Its first corner is an edge.
inline bool isKept(const CubeCase& cell, int triangle, const CellFeatures& loops) {
  return !loops.has(cell.loopOf[cell.triangles[triangle][0]]);
}

/// Whether the case has the mean of a loop's crossings, and that loop no feature.
inline bool hasCentre(const CubeCase& cell, const CellFeatures& loops) {
  if (cell.centreCount == 0) return false;
  return !loops.has(cell.loopOf[std::countr_zero(cell.aroundCentre[0])]);
}

}  // namespace tufa::extraction
