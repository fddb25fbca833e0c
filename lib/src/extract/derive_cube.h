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

/// In place of an edge: the first vertex inside the cell. Others follow it.
inline constexpr std::uint8_t kCentre = kEdges;
inline constexpr int kMostCentres = 4;

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

/// The triangles of a cell. Corners are edges, whose crossings are meant, or kCentre and above.
struct CubeCase {
  static constexpr int kMost = 18;
  std::array<std::array<std::uint8_t, 3>, kMost> triangles{};
  std::uint8_t count = 0;
  std::uint8_t centreCount = 0;  ///< vertices inside the cell
  /// For each of them bits of edges: it is the mean of their crossings.
  std::array<std::uint16_t, kMostCentres> aroundCentre{};
  std::uint8_t loopCount = 0;
  std::array<std::uint8_t, kEdges> loopOf{};  ///< of each crossed edge
  std::array<std::int8_t, kEdges> next{};     ///< in its loop; -1 for edges that are not crossed
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
inline constexpr auto kChordCosts = [] {
  std::array<std::array<int, kEdges>, kEdges> costs{};
  for (int a = 0; a < kEdges; ++a) {
    for (int b = 0; b < kEdges; ++b) {
      costs[a][b] = shareFace(a, b) ? kInFace : 0;
      for (int axis = 0; axis < 3; ++axis) {
        const int d = kMiddles[a][axis] - kMiddles[b][axis];
        costs[a][b] += d * d;
      }
    }
  }
  return costs;
}();

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
          best + (length + 1 < loop.size ? kChordCosts[loop.edges[i]][loop.edges[j]] : 0);
    }
  }
  return runs;
}

inline constexpr void addTriangle(CubeCase& cell, int a, int b, int c) {
  cell.triangles[cell.count++] = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b),
                                  static_cast<std::uint8_t>(c)};
}

inline constexpr int addCentre(CubeCase& cell, unsigned around) {
  cell.aroundCentre[cell.centreCount] = static_cast<std::uint16_t>(around);
  return kCentre + cell.centreCount++;
}

/// Adds the triangles of a disk that fills a loop. Where each triangulation has a chord in a face,
/// as only loops of eight and more between faces joined in both ways do, a fan around a vertex
/// inside the cell.
inline constexpr void fillLoop(const Loop& loop, CubeCase& cell) {
  const RunCosts runs = costsOf(loop);
  const auto& edges = loop.edges;
  if (runs.cost[0][loop.size - 1] >= kInFace) {
    unsigned around = 0;
    for (int i = 0; i < loop.size; ++i) {
      addTriangle(cell, edges[i], edges[(i + 1) % loop.size], kCentre + cell.centreCount);
      around |= 1u << edges[i];
    }
    addCentre(cell, around);
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

/// Pairs of loops that a tunnel may join. Cells of four loops have none.
inline constexpr int kTunnels = 3;
inline constexpr std::array<std::array<int, 2>, kTunnels> kTunnelEnds = {{{0, 1}, {0, 2}, {1, 2}}};

/// A tube between two loops: from the edge between `first[0]` and `second[start]`, one step after
/// another along the first loop or, as the other end of a tube runs the other way, back along the
/// second.
struct Tube {
  int cost = -1;
  int start = 0;
  std::array<std::array<bool, kEdges + 1>, kEdges + 1> alongSecond{};  ///< the last step to a place
};

/// The cheapest of those that begin at `start` with a step along the first loop and end with one
/// along the second, as any tube does that is seen from the right edge. Round one loop alone is no
/// way: there the tube would be pinched.
inline constexpr Tube tubeFrom(const Loop& first, const Loop& second, int start) {
  constexpr int kNoWay = 1000 * kInFace;
  const int n = first.size, m = second.size;
  Tube tube;
  tube.start = start;
  std::array<std::array<int, kEdges + 1>, kEdges + 1> cost{};
  for (int i = 0; i <= n; ++i) {
    for (int j = i == 0 ? 1 : 0; j <= m; ++j) {
      if (i == 0 || (i == n && j == 0) || (j == m && i < n)) {
        cost[i][j] = kNoWay;
        continue;
      }
      const bool back = j > 0 && cost[i][j - 1] < cost[i - 1][j];
      tube.alongSecond[i][j] = back;
      cost[i][j] = (back ? cost[i][j - 1] : cost[i - 1][j]) +
                   kChordCosts[first.edges[i % n]][second.edges[(start + m - j) % m]];
    }
  }
  tube.cost = cost[n][m];
  return tube;
}

inline constexpr void joinLoops(const Loop& first, const Loop& second, CubeCase& cell) {
  Tube best;
  for (int start = 0; start < second.size; ++start) {
    const Tube tube = tubeFrom(first, second, start);
    if (best.cost < 0 || tube.cost < best.cost) best = tube;
  }
  int i = first.size, j = second.size;
  while (i + j > 0) {
    const auto ofFirst = [&](int k) { return first.edges[k % first.size]; };
    const auto ofSecond = [&](int k) {
      return second.edges[(best.start + second.size - k) % second.size];
    };
    if (best.alongSecond[i][j]) {
      addTriangle(cell, ofSecond(j), ofSecond(j - 1), ofFirst(i));
      --j;
    } else {
      addTriangle(cell, ofFirst(i - 1), ofFirst(i), ofSecond(j));
      --i;
    }
  }
}

/// Puts the vertex `middle` onto the edge from `a` to `b` of one triangle; returns the bits of its
/// corners.
inline constexpr unsigned splitSide(CubeCase& cell, int a, int b, int middle) {
  const int count = cell.count;
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto t = cell.triangles[i];
      if (t[k] != a || t[(k + 1) % 3] != b) continue;
      const int apex = t[(k + 2) % 3];
      cell.triangles[i][(k + 1) % 3] = static_cast<std::uint8_t>(middle);
      addTriangle(cell, middle, b, apex);
      return 1u << a | 1u << b | (apex < kEdges ? 1u << apex : 0);
    }
  }
  return 0;
}

inline constexpr bool hasSide(const CubeCase& cell, int a, int b) {
  for (int i = 0; i < cell.count; ++i) {
    const auto& t = cell.triangles[i];
    for (int k = 0; k < 3; ++k) {
      if (t[k] == a && t[(k + 1) % 3] == b) return true;
    }
  }
  return false;
}

/// Splits the edges of two triangles that lie in a face, as some tubes must have them, by vertices
/// inside the cell: the cell beyond the face may have the same edge.
inline constexpr void leaveFaces(CubeCase& cell) {
  for (int i = 0; i < cell.count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const int a = cell.triangles[i][k], b = cell.triangles[i][(k + 1) % 3];
      if (a >= b || b >= kEdges || kChordCosts[a][b] < kInFace || !hasSide(cell, b, a)) continue;
      const int middle = kCentre + cell.centreCount;
      const unsigned around = splitSide(cell, a, b, middle) | splitSide(cell, b, a, middle);
      addCentre(cell, around);
    }
  }
}

/// Whether these loops may have that tunnel, counted from 1.
inline constexpr bool mayHave(const Loops& loops, int tunnel) {
  return tunnel > 0 && kTunnelEnds[tunnel - 1][1] < loops.count && loops.count <= kTunnels;
}

/// The cell's surface with a disk for each loop, or, for a tunnel, a tube between two of them.
inline constexpr CubeCase caseFor(const Loops& loops, int tunnel) {
  CubeCase cell;
  cell.loopCount = static_cast<std::uint8_t>(loops.count);
  for (std::int8_t& edge : cell.next) edge = -1;
  int one = -1, other = -1;
  if (tunnel > 0) {
    one = kTunnelEnds[tunnel - 1][0];
    other = kTunnelEnds[tunnel - 1][1];
    joinLoops(loops.loops[one], loops.loops[other], cell);
    leaveFaces(cell);
  }
  for (int i = 0; i < loops.count; ++i) {
    const Loop& loop = loops.loops[i];
    for (int k = 0; k < loop.size; ++k) {
      cell.loopOf[loop.edges[k]] = static_cast<std::uint8_t>(i);
      cell.next[loop.edges[k]] = static_cast<std::int8_t>(loop.edges[(k + 1) % loop.size]);
    }
    if (i != one && i != other) fillLoop(loop, cell);
  }
  return cell;
}

}  // namespace tufa::extraction
