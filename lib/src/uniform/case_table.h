#pragma once

#include <array>
#include <cstdint>

namespace tufa::uniform {

// Numbers inside a cell, all derived from one rule:
//   corner (dx, dy, dz)                     dx * 4 + dy * 2 + dz
//   edge along an axis                      axis * 4 + a * 2 + b, where a and b are its place along
//                                           the other two axes in rising order
//   face across an axis                     axis * 2 + (0 at the lower end, 1 at the upper)
inline constexpr int kCorners = 8;
inline constexpr int kEdges = 12;
inline constexpr int kFaces = 6;

/// Eight bits, one for each corner that is inside.
using CornerMask = std::uint8_t;
/// Six bits, one for each ambiguous face whose inside corners are joined.
using FaceBits = std::uint8_t;

/// The two axes other than `axis`, in rising order.
inline constexpr std::array<int, 2> otherAxes(int axis) {
  return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
}

/// The lower and upper corner of an edge.
inline constexpr std::array<int, 2> edgeCorners(int edge) {
  const int axis = edge / 4;
  const auto [u, v] = otherAxes(axis);
  const int lower = ((edge >> 1) & 1) << (2 - u) | (edge & 1) << (2 - v);
  return {lower, lower | 1 << (2 - axis)};
}

/// The corners of a face in cyclic order.
inline constexpr std::array<int, 4> faceCorners(int face) {
  const int axis = face / 2;
  const auto [u, v] = otherAxes(axis);
  const int base = (face & 1) << (2 - axis);
  const int stepU = 1 << (2 - u), stepV = 1 << (2 - v);
  return {base, base | stepU, base | stepU | stepV, base | stepV};
}

/// The edge between two neighbouring corners.
inline constexpr int edgeBetween(int a, int b) {
  for (int edge = 0; edge < kEdges; ++edge) {
    const auto [lower, upper] = edgeCorners(edge);
    if ((lower == a && upper == b) || (lower == b && upper == a)) return edge;
  }
  return -1;
}

/// Edge i of a face joins its corners i and i + 1.
inline constexpr auto kFaceEdges = [] {
  std::array<std::array<int, 4>, kFaces> all{};
  for (int face = 0; face < kFaces; ++face) {
    const auto corners = faceCorners(face);
    for (int i = 0; i < 4; ++i) all[face][i] = edgeBetween(corners[i], corners[(i + 1) % 4]);
  }
  return all;
}();

inline constexpr auto kFaceCorners = [] {
  std::array<std::array<int, 4>, kFaces> all{};
  for (int face = 0; face < kFaces; ++face) all[face] = faceCorners(face);
  return all;
}();

inline constexpr bool isInside(CornerMask mask, int corner) { return ((mask >> corner) & 1) != 0; }

inline constexpr bool isCrossed(CornerMask mask, int edge) {
  const auto [lower, upper] = edgeCorners(edge);
  return isInside(mask, lower) != isInside(mask, upper);
}

/// Whether the corners of a face alternate between inside and outside.
inline constexpr bool isAmbiguous(CornerMask mask, int face) {
  const auto& c = kFaceCorners[face];
  return isInside(mask, c[0]) == isInside(mask, c[2]) &&
         isInside(mask, c[1]) == isInside(mask, c[3]) &&
         isInside(mask, c[0]) != isInside(mask, c[1]);
}

/// Which cell component owns each crossing of a cell: the crossings, joined through the faces, form
/// closed loops, and each loop is one component (Nielson 2004).
class Components {
 public:
  constexpr Components() = default;

  /// The component, from 0, that owns the crossing of `edge`, which must be crossed and not open.
  [[nodiscard]] constexpr int of(int edge) const {
    return static_cast<int>(packed_ >> (3 * edge)) & 7;
  }
  /// Number of components: 0 to 4 loops, or up to 6 loops and chains where edges are open.
  [[nodiscard]] constexpr int count() const { return static_cast<int>(packed_ >> 36); }

  constexpr void set(int edge, int component) {
    packed_ |= static_cast<std::uint64_t>(component) << (3 * edge);
  }
  constexpr void setCount(int count) { packed_ |= static_cast<std::uint64_t>(count) << 36; }

 private:
  std::uint64_t packed_ = 0;
};

/// Joins the crossings of a cell. `openEdges` has a bit for each crossed edge that is left out
/// because the data ends there: loops through it fall apart into chains, each a component.
inline constexpr Components joinCrossings(CornerMask mask, FaceBits joined, unsigned openEdges) {
  std::array<int, kEdges> root{};
  for (int edge = 0; edge < kEdges; ++edge) {
    root[edge] = isCrossed(mask, edge) && ((openEdges >> edge) & 1) == 0 ? edge : -1;
  }
  const auto join = [&root](int a, int b) {
    if (root[a] < 0 || root[b] < 0 || root[a] == root[b]) return;
    const int keep = root[a] < root[b] ? root[a] : root[b];
    const int drop = root[a] < root[b] ? root[b] : root[a];
    for (int& r : root) r = r == drop ? keep : r;
  };
  for (int face = 0; face < kFaces; ++face) {
    const auto& edges = kFaceEdges[face];
    if (isAmbiguous(mask, face)) {
      // An arc cuts off corner i between its edges i - 1 and i: around the inside corners, or,
      // where those are joined, around the outside ones.
      const bool cutOffInside = ((joined >> face) & 1) == 0;
      const int first = isInside(mask, kFaceCorners[face][0]) == cutOffInside ? 0 : 1;
      join(edges[(first + 3) % 4], edges[first]);
      join(edges[first + 1], edges[first + 2]);
      continue;
    }
    int before = -1;
    for (const int edge : edges) {
      if (!isCrossed(mask, edge)) continue;
      if (before >= 0) join(before, edge);
      before = edge;
    }
  }
  Components components;
  int count = 0;
  std::array<int, kEdges> number{};
  for (int edge = 0; edge < kEdges; ++edge) {
    if (root[edge] < 0) continue;
    if (root[edge] == edge) number[edge] = count++;
    components.set(edge, number[root[edge]]);
  }
  components.setCount(count);
  return components;
}

/// joinCrossings() without open edges, from a table made at compile time.
[[nodiscard]] Components componentsOf(CornerMask mask, FaceBits joined);

/// The six bits of the ambiguous faces of a cell.
[[nodiscard]] FaceBits ambiguousFaces(CornerMask mask);

}  // namespace tufa::uniform
