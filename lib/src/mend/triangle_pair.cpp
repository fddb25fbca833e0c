#include "mend/triangle_pair.h"

#include <algorithm>
#include <array>
#include <utility>

#include "mend/exact.h"

namespace tufa::mend {
namespace {

using Corners = std::array<Position, 3>;

// Moves the common vertices of two triangles to their fronts, in the same order; returns how many.
int alignShared(std::array<VertexIndex, 3>& a, std::array<VertexIndex, 3>& b) {
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    const auto found = std::find(b.begin() + shared, b.end(), a[i]);
    if (found == b.end()) continue;
    std::iter_swap(b.begin() + shared, found);
    std::swap(a[shared], a[i]);
    ++shared;
  }
  return shared;
}

// An axis along which the triangle is seen with an area; -1 if its corners lie on a line.
int facingAxis(const Corners& t) {
  for (int axis = 0; axis < 3; ++axis) {
    if (orientationAcross(axis, t[0], t[1], t[2]) != 0) return axis;
  }
  return -1;
}

// All in one plane. Two convex figures are apart if a line along a side of one parts them.
bool meetsInPlane(const Position& p, const Position& q, const Corners& t) {
  const int axis = facingAxis(t);
  if (axis < 0) return false;
  const int turn = orientationAcross(axis, t[0], t[1], t[2]);
  for (int i = 0; i < 3; ++i) {
    const Position& from = t[i];
    const Position& to = t[(i + 1) % 3];
    if (orientationAcross(axis, from, to, p) == -turn &&
        orientationAcross(axis, from, to, q) == -turn) {
      return false;
    }
  }
  const int first = orientationAcross(axis, p, q, t[0]);
  return first == 0 || first != orientationAcross(axis, p, q, t[1]) ||
         first != orientationAcross(axis, p, q, t[2]);
}

bool segmentMeets(const Position& p, const Position& q, const Corners& t) {
  const int sideP = orientation(t[0], t[1], t[2], p), sideQ = orientation(t[0], t[1], t[2], q);
  if (sideP == sideQ) return sideP == 0 && meetsInPlane(p, q, t);
  bool left = false, right = false;
  for (int i = 0; i < 3; ++i) {
    const int side = orientation(p, q, t[i], t[(i + 1) % 3]);
    left |= side > 0;
    right |= side < 0;
  }
  return !(left && right);
}

// Whether all corners of b but the first `skip` are strictly on one side of the plane of a.
bool isBeside(const Corners& a, const Corners& b, int skip) {
  const int side = orientation(a[0], a[1], a[2], b[skip]);
  if (side == 0) return false;
  for (int i = skip + 1; i < 3; ++i) {
    if (orientation(a[0], a[1], a[2], b[i]) != side) return false;
  }
  return true;
}

bool meetAnywhere(const Corners& a, const Corners& b) {
  if (isBeside(a, b, 0) || isBeside(b, a, 0)) return false;
  for (int i = 0; i < 3; ++i) {
    if (segmentMeets(a[i], a[(i + 1) % 3], b) || segmentMeets(b[i], b[(i + 1) % 3], a)) return true;
  }
  return false;
}

bool meetBeyondVertex(const Corners& a, const Corners& b) {
  if (isBeside(a, b, 1) || isBeside(b, a, 1)) return false;
  return segmentMeets(b[1], b[2], a) || segmentMeets(a[1], a[2], b);
}

bool isFoldedOver(const Corners& a, const Corners& b) {
  if (orientation(a[0], a[1], a[2], b[2]) != 0) return false;
  const int axis = facingAxis(a);
  return axis >= 0 &&
         orientationAcross(axis, a[0], a[1], a[2]) == orientationAcross(axis, a[0], a[1], b[2]);
}

}  // namespace

bool meetElsewhere(std::span<const Position> positions, const Triangle& a, const Triangle& b) {
  auto va = a.vertices;
  auto vb = b.vertices;
  const int shared = alignShared(va, vb);
  const Corners pa{positions[va[0]], positions[va[1]], positions[va[2]]};
  const Corners pb{positions[vb[0]], positions[vb[1]], positions[vb[2]]};
  const bool meet = shared == 0   ? meetAnywhere(pa, pb)
                    : shared == 1 ? meetBeyondVertex(pa, pb)
                    : shared == 2 ? isFoldedOver(pa, pb)
                                  : true;
  return meet && facingAxis(pa) >= 0 && facingAxis(pb) >= 0;
}

bool isFlat(std::span<const Position> positions, const Triangle& triangle) {
  const auto& v = triangle.vertices;
  return facingAxis({positions[v[0]], positions[v[1]], positions[v[2]]}) < 0;
}

}  // namespace tufa::mend
