#pragma once

#include <array>
#include <cstdint>

#include "uniform/case_table.h"

// Ways to split the cells into tetrahedra, and the edges these have, derived at compile time from
// the geometry of the cube.

namespace tufa::extraction {

/// Points of a cell: its corners, the centres of its faces, its own centre, and the centres of the
/// cells beyond its faces.
inline constexpr int kFaceCentre = 8;
inline constexpr int kCellCentre = 14;
inline constexpr int kCentreBeyond = 15;
inline constexpr int kPoints = 21;

/// A place in half voxels from the lowest corner of a cell. A point at odd coordinates is a centre:
/// its value is the mean of the samples around it.
using HalfPlace = std::array<int, 3>;

inline constexpr auto kPlaces = [] {
  std::array<HalfPlace, kPoints> places{};
  for (int corner = 0; corner < uniform::kCorners; ++corner) {
    places[corner] = {corner >> 2 << 1, corner & 2, (corner & 1) << 1};
  }
  places[kCellCentre] = {1, 1, 1};
  for (int face = 0; face < uniform::kFaces; ++face) {
    const int step = (face & 1) != 0 ? 1 : -1;
    places[kFaceCentre + face] = places[kCentreBeyond + face] = {1, 1, 1};
    places[kFaceCentre + face][face / 2] += step;
    places[kCentreBeyond + face][face / 2] += 2 * step;
  }
  return places;
}();

/// Which cells have a tetrahedron.
enum class Where : std::uint8_t {
  Everywhere,
  EvenCells,  ///< the sum of the cell's coordinates is even
  OddCells,
  NoCellBelow0,  ///< the cell below on that axis is no surface cell, and so walks no tetrahedra
  NoCellBelow1,
  NoCellBelow2,
};

/// Four points whose order is that of a right-handed frame: the last three are seen
/// counter-clockwise from the side that the first is not on.
struct Tetrahedron {
  std::array<int, 4> points{};
  Where where = Where::Everywhere;
};

inline constexpr int volumeOf(const std::array<int, 4>& points) {
  std::array<HalfPlace, 3> from{};
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      from[i][axis] = kPlaces[points[i + 1]][axis] - kPlaces[points[0]][axis];
    }
  }
  const auto& [a, b, c] = from;
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

inline constexpr Tetrahedron tetrahedron(std::array<int, 4> points, Where where) {
  if (volumeOf(points) < 0) {
    const int swapped = points[2];
    points[2] = points[3];
    points[3] = swapped;
  }
  return {points, where};
}

// A split names its tetrahedra; kGroupSize of them, which the same cells have, share their points
// and are looked up together.

/// Five: a middle one and four at corners, mirrored from cell to cell, so that the diagonals of a
/// face are the same on both sides: they join lattice points of even sums.
struct SplitInFive {
  static constexpr int kGroupSize = 5;
  static constexpr auto kTetrahedra = [] {
    std::array<Tetrahedron, 10> all{};
    for (int odd = 0; odd < 2; ++odd) {
      const Where where = odd != 0 ? Where::OddCells : Where::EvenCells;
      const int turned = odd != 0 ? 7 : 0;
      constexpr std::array<int, 4> middle = {0, 3, 5, 6};
      std::array<int, 4> points{};
      for (int i = 0; i < 4; ++i) points[i] = middle[i] ^ turned;
      all[odd * 5] = tetrahedron(points, where);
      for (int i = 0; i < 4; ++i) {
        auto cornered = points;
        cornered[i] ^= 7;  // the corner that the other three are neighbours of
        all[odd * 5 + 1 + i] = tetrahedron(cornered, where);
      }
    }
    return all;
  }();
};

/// Six around the diagonal from the lowest corner to the highest: one for each order of the axes.
struct SplitInSix {
  static constexpr int kGroupSize = 6;
  static constexpr auto kTetrahedra = [] {
    std::array<Tetrahedron, 6> all{};
    for (int i = 0; i < 6; ++i) {
      const int first = i / 2, second = (first + 1 + i % 2) % 3;
      const int one = 4 >> first, two = one | 4 >> second;
      all[i] = tetrahedron({0, one, two, 7}, Where::Everywhere);
    }
    return all;
  }();
};

/// Twenty-four of one shape: the cell's centre, a face's centre and an edge of that face.
struct SplitInTwentyFour {
  static constexpr int kGroupSize = 4;
  static constexpr auto kTetrahedra = [] {
    std::array<Tetrahedron, 24> all{};
    for (int i = 0; i < 24; ++i) {
      const auto& corners = uniform::kFaceCorners[i / 4];
      all[i] = tetrahedron({kCellCentre, kFaceCentre + i / 4, corners[i % 4], corners[(i + 1) % 4]},
                           Where::Everywhere);
    }
    return all;
  }();
};

/// The body-centred cubic lattice: two neighbouring centres and an edge of the face between them. A
/// cell has those across its upper faces, and those across a lower one if the cell there has none.
struct BodyCentred {
  static constexpr int kGroupSize = 4;
  static constexpr auto kTetrahedra = [] {
    constexpr std::array<Where, 3> none = {Where::NoCellBelow0, Where::NoCellBelow1,
                                           Where::NoCellBelow2};
    std::array<Tetrahedron, 24> all{};
    for (int i = 0; i < 24; ++i) {
      const int face = i / 4;
      const auto& corners = uniform::kFaceCorners[face];
      all[i] =
          tetrahedron({kCellCentre, kCentreBeyond + face, corners[i % 4], corners[(i + 1) % 4]},
                      (face & 1) != 0 ? Where::Everywhere : none[face / 2]);
    }
    return all;
  }();
};

/// The corners of the edges of a tetrahedron.
inline constexpr std::array<std::array<int, 2>, 6> kTetrahedronEdges = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// The triangles of a tetrahedron, of numbers of its edges.
struct TetrahedronCase {
  std::array<std::array<std::uint8_t, 3>, 2> triangles{};
  std::uint8_t count = 0;
};

/// The 16 cases, three but for symmetry: none, one corner cut off, or two and two apart.
inline constexpr auto kTetrahedronCases = [] {
  const auto edge = [](int a, int b) {
    for (int i = 0; i < 6; ++i) {
      const auto [from, to] = kTetrahedronEdges[i];
      if ((from == a && to == b) || (from == b && to == a)) return static_cast<std::uint8_t>(i);
    }
    return std::uint8_t{255};
  };
  std::array<TetrahedronCase, 16> cases{};
  for (int mask = 1; mask < 15; ++mask) {
    // The inside corners first, in an even order.
    std::array<int, 4> order{};
    int inside = 0, next = 0;
    for (int i = 0; i < 4; ++i) inside += (mask >> i) & 1;
    for (const int side : {1, 0}) {
      for (int i = 0; i < 4; ++i) {
        if (((mask >> i) & 1) == side) order[next++] = i;
      }
    }
    bool odd = false;
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) odd ^= order[i] > order[j];
    }
    if (odd && inside == 3) {
      const int swapped = order[0];
      order[0] = order[1];
      order[1] = swapped;
    } else if (odd) {
      const int swapped = order[2];
      order[2] = order[3];
      order[3] = swapped;
    }
    const auto [a, b, c, d] = order;
    TetrahedronCase& found = cases[mask];
    if (inside == 1) {
      found.triangles[found.count++] = {edge(a, b), edge(a, c), edge(a, d)};
    } else if (inside == 3) {
      found.triangles[found.count++] = {edge(d, a), edge(d, b), edge(d, c)};
    } else {
      found.triangles[found.count++] = {edge(a, c), edge(a, d), edge(b, d)};
      found.triangles[found.count++] = {edge(a, c), edge(b, d), edge(b, c)};
    }
  }
  return cases;
}();

/// A kind of edge: its ends, seen from the cell that it belongs to, and which cells have it.
struct EdgeKind {
  HalfPlace from{}, to{};
  std::array<bool, 2> parities{};  ///< even cells, odd cells
  int reach = 0;                   ///< see EdgeTable
};

/// An edge of a tetrahedron of a cell: its kind, and the steps up to the cell that it belongs to.
struct EdgeOfCell {
  int kind = 0;
  std::array<int, 3> steps{};
};

/// The kinds of edges of a split, and for each of its tetrahedra the six it has.
template <std::size_t kCount>
struct SplitEdges {
  std::array<EdgeKind, 48> kinds{};
  int count = 0;
  std::array<std::array<EdgeOfCell, 6>, kCount> edges{};
};

/// Edges belong to the cell whose lowest corner is the least coordinate of both ends. Those towards
/// the centre below, which no other cell asks for, belong to the cell itself.
template <std::size_t kCount>
constexpr SplitEdges<kCount> edgesOf(const std::array<Tetrahedron, kCount>& tetrahedra) {
  SplitEdges<kCount> all;
  for (std::size_t t = 0; t < kCount; ++t) {
    for (int e = 0; e < 6; ++e) {
      HalfPlace from = kPlaces[tetrahedra[t].points[kTetrahedronEdges[e][0]]];
      HalfPlace to = kPlaces[tetrahedra[t].points[kTetrahedronEdges[e][1]]];
      EdgeOfCell& edge = all.edges[t][e];
      int moved = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const int least = from[axis] < to[axis] ? from[axis] : to[axis];
        edge.steps[axis] = least < 2 ? 0 : 1;
        from[axis] -= 2 * edge.steps[axis];
        to[axis] -= 2 * edge.steps[axis];
        moved |= edge.steps[axis] << (2 - axis);
      }
      if (to < from) {
        const HalfPlace swapped = from;
        from = to;
        to = swapped;
      }
      edge.kind = 0;
      while (edge.kind < all.count &&
             (all.kinds[edge.kind].from != from || all.kinds[edge.kind].to != to)) {
        ++edge.kind;
      }
      if (edge.kind == all.count) {
        all.kinds[all.count].from = from;
        all.kinds[all.count++].to = to;
      }
      EdgeKind& kind = all.kinds[edge.kind];
      kind.reach |= moved;
      const bool oddSteps = ((edge.steps[0] + edge.steps[1] + edge.steps[2]) & 1) != 0;
      const Where where = tetrahedra[t].where;
      if (where != Where::OddCells) kind.parities[oddSteps ? 1 : 0] = true;
      if (where != Where::EvenCells) kind.parities[oddSteps ? 0 : 1] = true;
    }
  }
  return all;
}

}  // namespace tufa::extraction
