#pragma once

#include <array>
#include <cstdint>

#include "uniform/case_table.h"

// How the surface of a cell is triangulated, derived at compile time from the geometry of the cube.
// Numbers of corners, edges and faces are those of uniform/case_table.h.

namespace tufa::extraction {

using uniform::CornerMask;
using uniform::FaceBits;
using uniform::kCorners;
using uniform::kEdges;
using uniform::kFaces;

/// In place of an edge: the vertex inside the cell.
inline constexpr std::uint8_t kCentre = kEdges;

/// Crossings that the surface joins through the faces of a cell, in order: counter-clockwise seen
/// from outside of the solid.
struct Loop {
  std::array<std::uint8_t, kEdges> edges{};
  int size = 0;
};

/// All loops of a cell. Each crossed edge is in one of them.
struct Loops {
  std::array<Loop, 4> loops{};
  int count = 0;
};

/// The triangles of a cell. Corners are edges, whose crossings are meant, or kCentre.
struct CubeCase {
  static constexpr int kMost = 12;
  std::array<std::array<std::uint8_t, 3>, kMost> triangles{};
  std::uint8_t count = 0;
  /// Bits of the edges whose crossings are around the vertex inside the cell; 0: there is none.
  std::uint16_t aroundCentre = 0;
};

/// The middle of an edge, in half voxels.
inline constexpr std::array<int, 3> middleOf(int edge) {
  const auto [lower, upper] = uniform::edgeCorners(edge);
  std::array<int, 3> middle{};
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = ((lower >> (2 - axis)) & 1) + ((upper >> (2 - axis)) & 1);
  }
  return middle;
}

inline constexpr auto kMiddles = [] {
  std::array<std::array<int, 3>, kEdges> all{};
  for (int edge = 0; edge < kEdges; ++edge) all[edge] = middleOf(edge);
  return all;
}();

/// Whether a face holds both edges.
inline constexpr bool shareFace(int a, int b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (kMiddles[a][axis] == kMiddles[b][axis] && kMiddles[a][axis] != 1) return true;
  }
  return false;
}

/// Whether kFaceCorners runs counter-clockwise seen from outside of the cell: the cross product of
/// the first two other axes in rising order points up for the axes 0 and 2, and down for 1.
inline constexpr bool runsCounterClockwise(int face) {
  return ((face & 1) != 0) == (face / 2 != 1);
}

/// For each crossed edge the next one of its loop. Walking an arc of a face seen from outside of
/// the cell, the inside is on the right: that is counter-clockwise seen from outside of the solid.
inline constexpr std::array<int, kEdges> nextCrossings(CornerMask mask, FaceBits joined) {
  std::array<int, kEdges> next{};
  for (int& n : next) n = -1;
  for (int face = 0; face < kFaces; ++face) {
    const auto& corners = uniform::kFaceCorners[face];
    const auto& edges = uniform::kFaceEdges[face];
    const bool backward = uniform::isAmbiguous(mask, face) && ((joined >> face) & 1) != 0;
    for (int i = 0; i < 4; ++i) {
      const auto isIn = [&](int corner) { return uniform::isInside(mask, corners[corner % 4]); };
      if (isIn(i) || !isIn(i + 1)) continue;
      // Edge i enters the inside; its arc ends at the next edge that leaves it, or, around an
      // outside corner, at the one before.
      int leave = backward ? i + 3 : i + 1;
      while (!isIn(leave) || isIn(leave + 1)) ++leave;
      const int from = edges[i], to = edges[leave % 4];
      if (runsCounterClockwise(face)) {
        next[from] = to;
      } else {
        next[to] = from;
      }
    }
  }
  return next;
}

inline constexpr Loops loopsOf(CornerMask mask, FaceBits joined) {
  const std::array<int, kEdges> next = nextCrossings(mask, joined);
  Loops all;
  unsigned seen = 0;
  for (int first = 0; first < kEdges; ++first) {
    if (next[first] < 0 || ((seen >> first) & 1) != 0) continue;
    Loop& loop = all.loops[all.count++];
    for (int edge = first; ((seen >> edge) & 1) == 0; edge = next[edge]) {
      seen |= 1u << edge;
      loop.edges[loop.size++] = static_cast<std::uint8_t>(edge);
    }
  }
  return all;
}

/// What a chord of a loop costs: its squared length, taken between the middles of the edges, in
/// half voxels, and far more if it would lie in a face: there the cell beyond may have the same
/// chord, and the edge four triangles.
inline constexpr int kInFace = 1000;
inline constexpr int chordCost(int a, int b) {
  int cost = shareFace(a, b) ? kInFace : 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int d = kMiddles[a][axis] - kMiddles[b][axis];
    cost += d * d;
  }
  return cost;
}

/// The cheapest ways to triangulate all runs of a loop (Klincsek 1980).
struct RunCosts {
  std::array<std::array<int, kEdges>, kEdges> cost{};
  std::array<std::array<std::int8_t, kEdges>, kEdges> apex{};
};

inline constexpr RunCosts costsOf(const Loop& loop) {
  RunCosts runs;
  for (int length = 2; length < loop.size; ++length) {
    for (int i = 0; i + length < loop.size; ++i) {
      const int j = i + length;
      int best = -1;
      for (int k = i + 1; k < j; ++k) {
        const int cost = runs.cost[i][k] + runs.cost[k][j];
        if (best >= 0 && cost >= best) continue;
        best = cost;
        runs.apex[i][j] = static_cast<std::int8_t>(k);
      }
      runs.cost[i][j] =
          best + (length + 1 < loop.size ? chordCost(loop.edges[i], loop.edges[j]) : 0);
    }
  }
  return runs;
}

inline constexpr void addTriangle(CubeCase& cell, int a, int b, int c) {
  cell.triangles[cell.count++] = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b),
                                  static_cast<std::uint8_t>(c)};
}

/// Adds the triangles of a disk that fills a loop. Where each triangulation has a chord in a face,
/// as only loops of eight and more between faces joined in both ways do, a fan around a vertex
/// inside the cell.
inline constexpr void fillLoop(const Loop& loop, CubeCase& cell) {
  const RunCosts runs = costsOf(loop);
  const auto& edges = loop.edges;
  if (runs.cost[0][loop.size - 1] >= kInFace) {
    for (int i = 0; i < loop.size; ++i) {
      addTriangle(cell, edges[i], edges[(i + 1) % loop.size], kCentre);
      cell.aroundCentre = static_cast<std::uint16_t>(cell.aroundCentre | 1 << edges[i]);
    }
    return;
  }
  std::array<std::array<int, 2>, kEdges> open{};
  int count = 0;
  open[count++] = {0, loop.size - 1};
  while (count > 0) {
    const auto [i, j] = open[--count];
    if (j - i < 2) continue;
    const int k = runs.apex[i][j];
    addTriangle(cell, edges[i], edges[k], edges[j]);
    open[count++] = {i, k};
    open[count++] = {k, j};
  }
}

/// The cell's surface with a disk for each loop.
inline constexpr CubeCase diskCase(CornerMask mask, FaceBits joined) {
  const Loops loops = loopsOf(mask, joined);
  CubeCase cell;
  for (int i = 0; i < loops.count; ++i) fillLoop(loops.loops[i], cell);
  return cell;
}

}  // namespace tufa::extraction
