#pragma once

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "uniform/case_table.h"

namespace tufa::uniform::cells {

/// Edges of a cell that belong together.
using Partition = std::set<std::set<int>>;

/// Joins of two crossings through a face.
using Arcs = std::vector<std::pair<int, int>>;

inline bool differsIn(int a, int b, int axis) { return (a ^ b) == 1 << (2 - axis); }

/// The edge between two corners by the stated numbering, or -1.
inline int edgeOf(int a, int b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!differsIn(a, b, axis)) continue;
    std::array<int, 2> place{};
    for (int other = 0, next = 0; other < 3; ++other) {
      if (other != axis) place[next++] = (a >> (2 - other)) & 1;
    }
    return axis * 4 + place[0] * 2 + place[1];
  }
  return -1;
}

inline std::vector<int> cornersOf(int face) {
  std::vector<int> corners;
  for (int corner = 0; corner < 8; ++corner) {
    if (((corner >> (2 - face / 2)) & 1) == (face & 1)) corners.push_back(corner);
  }
  return corners;
}

/// The arcs of one face, from its corners alone: two crossings are joined; of four, the two around
/// each corner that is cut off.
inline Arcs arcsOf(CornerMask mask, int face, bool joined) {
  const std::vector<int> corners = cornersOf(face);
  std::vector<int> crossed;
  for (const int a : corners) {
    for (const int b : corners) {
      const int edge = a < b ? edgeOf(a, b) : -1;
      if (edge >= 0 && ((mask >> a) & 1) != ((mask >> b) & 1)) crossed.push_back(edge);
    }
  }
  if (crossed.empty()) return {};
  if (crossed.size() == 2) return {{crossed[0], crossed[1]}};
  Arcs arcs;
  for (const int a : corners) {
    const bool inside = ((mask >> a) & 1) != 0;
    if (inside == joined) continue;
    std::vector<int> around;
    for (const int b : corners) {
      if (edgeOf(a, b) >= 0) around.push_back(edgeOf(a, b));
    }
    arcs.emplace_back(std::min(around[0], around[1]), std::max(around[0], around[1]));
  }
  return arcs;
}

inline Arcs arcsOf(CornerMask mask, FaceBits joined) {
  Arcs all;
  for (int face = 0; face < kFaces; ++face) {
    const Arcs arcs = arcsOf(mask, face, ((joined >> face) & 1) != 0);
    all.insert(all.end(), arcs.begin(), arcs.end());
  }
  return all;
}

/// Crossings that chains of arcs join, those of cut edges left out.
inline Partition partitionOf(CornerMask mask, FaceBits joined, unsigned openEdges) {
  Partition parts;
  for (int a = 0; a < 8; ++a) {
    for (int b = a + 1; b < 8; ++b) {
      const int edge = edgeOf(a, b);
      if (edge >= 0 && ((mask >> a) & 1) != ((mask >> b) & 1) && ((openEdges >> edge) & 1) == 0) {
        parts.insert({edge});
      }
    }
  }
  for (const auto& arc : arcsOf(mask, joined)) {
    const auto with = [&parts](int edge) {
      return std::find_if(parts.begin(), parts.end(),
                          [edge](const std::set<int>& part) { return part.count(edge) != 0; });
    };
    const auto first = with(arc.first), second = with(arc.second);
    if (first == parts.end() || second == parts.end() || first == second) continue;
    std::set<int> both = *first;
    both.insert(second->begin(), second->end());
    parts.erase(first);
    parts.erase(with(arc.second));
    parts.insert(both);
  }
  return parts;
}

/// The same out of a Components.
inline Partition partitionOf(const Components& components, CornerMask mask, unsigned openEdges) {
  std::vector<std::set<int>> parts(static_cast<std::size_t>(components.count()));
  for (int edge = 0; edge < kEdges; ++edge) {
    if (isCrossed(mask, edge) && ((openEdges >> edge) & 1) == 0) {
      parts.at(static_cast<std::size_t>(components.of(edge))).insert(edge);
    }
  }
  return {parts.begin(), parts.end()};
}

/// Calls body(mask, joined) for all 256 masks and all bits of their ambiguous faces.
template <class Body>
void forAllCells(const Body& body) {
  for (int mask = 0; mask < 256; ++mask) {
    const FaceBits ambiguous = ambiguousFaces(static_cast<CornerMask>(mask));
    for (int joined = 0; joined < 64; ++joined) {
      if ((joined & ambiguous) == joined) {
        body(static_cast<CornerMask>(mask), static_cast<FaceBits>(joined));
      }
    }
  }
}

}  // namespace tufa::uniform::cells
