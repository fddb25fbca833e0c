#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "extract/block_edges.h"
#include "extract/derive_tetrahedra.h"

namespace tufa::extraction {

/// What is known of a cell: a bit for each point that is inside, and some more.
using CellBits = std::uint32_t;
inline constexpr int kFirstNoCellBelow = kPoints;  ///< three bits
/// Three bits: no tetrahedra across that upper face.
inline constexpr int kFirstDropped = kPoints + 3;
/// No tetrahedra at all.
inline constexpr CellBits kDropped = CellBits{1} << (kFirstDropped + 3);

/// The points of some tetrahedra, in rising order: corners first.
struct GroupPoints {
  std::array<int, 8> points{};
  int count = 0;
  int corners = 0;
};

/// The edges of a split, and the triangles of its groups of tetrahedra by which of their points are
/// inside, derived from the split.
template <class Split>
struct TetrahedraLattice {
  static constexpr auto kTetrahedra = Split::kTetrahedra;
  static constexpr int kGroupSize = Split::kGroupSize;
  static constexpr int kGroups = static_cast<int>(kTetrahedra.size()) / kGroupSize;
  static constexpr auto kEdges = edgesOf(kTetrahedra);
  static constexpr int kKinds = kEdges.count;
  static constexpr auto kReach = [] {
    std::array<int, kKinds> reach{};
    for (int kind = 0; kind < kKinds; ++kind) reach[kind] = kEdges.kinds[kind].reach;
    return reach;
  }();
  using Table = EdgeTable<TetrahedraLattice>;

  /// Which of a cell's points is at a place; -1 for none.
  static constexpr int pointAt(const HalfPlace& place) {
    for (int point = 0; point < kPoints; ++point) {
      if (kPlaces[point] == place) return point;
    }
    return -1;
  }
  /// The points that edges of each kind join.
  static constexpr auto kEnds = [] {
    std::array<std::array<int, 2>, kKinds> ends{};
    for (int kind = 0; kind < kKinds; ++kind) {
      ends[kind] = {pointAt(kEdges.kinds[kind].from), pointAt(kEdges.kinds[kind].to)};
    }
    return ends;
  }();
  static constexpr unsigned kUsedPoints = [] {
    unsigned used = 0;
    for (const Tetrahedron& tetrahedron : kTetrahedra) {
      for (const int point : tetrahedron.points) used |= 1u << point;
    }
    return used;
  }();
  static constexpr bool kFaceCentres = (kUsedPoints >> kFaceCentre & 1) != 0;
  static constexpr bool kCentres = (kUsedPoints >> kCellCentre & 1) != 0;
  static constexpr bool kCentresBeyond = kUsedPoints >> kCentreBeyond != 0;

  static constexpr auto kGroupPoints = [] {
    std::array<GroupPoints, kGroups> groups{};
    for (int g = 0; g < kGroups; ++g) {
      unsigned used = 0;
      for (int t = g * kGroupSize; t < (g + 1) * kGroupSize; ++t) {
        for (const int point : kTetrahedra[t].points) used |= 1u << point;
      }
      for (int point = 0; point < kPoints; ++point) {
        if ((used >> point & 1) == 0) continue;
        groups[g].points[groups[g].count++] = point;
        groups[g].corners += point < uniform::kCorners ? 1 : 0;
      }
    }
    return groups;
  }();
  /// For each corner mask of a cell, that of the corners of a group.
  static constexpr auto kCornersOf = [] {
    std::array<std::array<std::uint8_t, 256>, kGroups> all{};
    for (int g = 0; g < kGroups; ++g) {
      for (int mask = 0; mask < 256; ++mask) {
        for (int i = 0; i < kGroupPoints[g].corners; ++i) {
          const int inside = mask >> kGroupPoints[g].points[i] & 1;
          all[g][mask] = static_cast<std::uint8_t>(all[g][mask] | inside << i);
        }
      }
    }
    return all;
  }();
  /// Triangles, each corner as what to add to the place of a cell, see EdgeTable.
  struct Case {
    std::array<std::array<std::uint16_t, 3>, 2 * kGroupSize> triangles{};
    std::uint8_t count = 0;
  };
  /// Adds those of a tetrahedron.
  static constexpr void add(int t, unsigned inside, Case& found) {
    unsigned mask = 0;
    for (int i = 0; i < 4; ++i) mask |= (inside >> kTetrahedra[t].points[i] & 1) << i;
    const TetrahedronCase& one = kTetrahedronCases[mask];
    for (int k = 0; k < one.count; ++k) {
      for (int corner = 0; corner < 3; ++corner) {
        const EdgeOfCell& edge = kEdges.edges[t][one.triangles[k][corner]];
        found.triangles[found.count][corner] = static_cast<std::uint16_t>(
            Table::offsetOf(edge.kind, edge.steps[0], edge.steps[1], edge.steps[2]));
      }
      ++found.count;
    }
  }

  static constexpr int kPatterns = 1 << kGroupPoints[0].count;
  static constexpr auto kCases = [] {
    std::array<std::array<Case, kPatterns>, kGroups> all{};
    for (int g = 0; g < kGroups; ++g) {
      for (int pattern = 0; pattern < kPatterns; ++pattern) {
        unsigned inside = 0;
        for (int i = 0; i < kGroupPoints[g].count; ++i) {
          inside |= static_cast<unsigned>(pattern >> i & 1) << kGroupPoints[g].points[i];
        }
        for (int t = g * kGroupSize; t < (g + 1) * kGroupSize; ++t) {
          add(t, inside, all[g][pattern]);
        }
      }
    }
    return all;
  }();

  /// Calls body(case) for each group of tetrahedra of a cell. `parity`: 1 for cells whose
  /// coordinates have an odd sum.
  template <class Body>
  static void forGroups(CellBits bits, int parity, const Body& body) {
    if ((bits & kDropped) != 0) return;
    [&]<std::size_t... g>(std::index_sequence<g...>) { (visitGroup<g>(bits, parity, body), ...); }
    (std::make_index_sequence<kGroups>());
  }

 private:
  template <std::size_t g, class Body>
  static void visitGroup(CellBits bits, int parity, const Body& body) {
    constexpr GroupPoints group = kGroupPoints[g];
    constexpr Where where = kTetrahedra[g * kGroupSize].where;
    if (where == Where::EvenCells && parity != 0) return;
    if (where == Where::OddCells && parity == 0) return;
    if constexpr (where >= Where::NoCellBelow0) {
      constexpr int axis = static_cast<int>(where) - static_cast<int>(Where::NoCellBelow0);
      if (((bits >> (kFirstNoCellBelow + axis)) & 1) == 0) return;
    } else if constexpr (kCentresBeyond) {
      constexpr int axis = (group.points[group.count - 1] - kCentreBeyond) / 2;
      if (((bits >> (kFirstDropped + axis)) & 1) != 0) return;
    }
    unsigned pattern = kCornersOf[g][bits & 0xff];
    [&]<int... i>(std::integer_sequence<int, i...>) {
      ((pattern |= (bits >> group.points[group.corners + i] & 1) << (group.corners + i)), ...);
    }
    (std::make_integer_sequence<int, group.count - group.corners>());
    body(kCases[g][pattern]);
  }
};

}  // namespace tufa::extraction
