#include "reduce/reference_mesh.h"

#include <utility>

#include "base/huge_pages.h"

namespace tufa::reduce {
ReferenceMesh::ReferenceMesh(const Surface& input, std::vector<float> scales, base::Job& job)
    : positions_(input.position), faces_(input.triangles), scales_(std::move(scales)) {
  base::resizeLarge(opposite_, faces_.areHalves() ? 2 * faces_.size() : 3 * faces_.size(), job);
  base::resizeLarge(cornerOf_, input.position.size(), job, kNone);
  base::resizeLarge(marks_, input.position.size(), job);
  forCornerRanges(positions_.size(), faces_, job, [&](const CornersOfVertices& corners) {
    forOppositeCorners(faces_, corners, corners.begin(), corners.end(),
                       [&](Index c, Index other) { setOpposite(c, other); });
    for (Index v = corners.begin(); v < corners.end(); ++v) {
      if (!corners.of(v).empty()) cornerOf_[v] = corners.of(v).back();
      marks_[v] = (input.flags[v] & (kSteep | kBorder)) != 0 ? kRough : 0;
      if ((input.flags[v] & kBent) != 0) marks_[v] |= kIsBent;
    }
  });
}

void ReferenceMesh::setOpposite(Index c, Index other) {
  const Index i = c % 6;
  if (!faces_.areHalves()) {
    opposite_[c] = other;
  } else if (i != 1 && i != 5) {
    opposite_[4 * (c / 6) + (i == 0 ? 0 : i - 1)] = other;
  }
}

void ReferenceMesh::hold(std::span<const Index> faces, float radius, float share, base::Job& job) {
  constexpr float kTogether = 0.125f;
  const float close2 = kTogether * kTogether * radius * radius;
  std::vector<Index> seenFrom(positions_.size(), kNone), reached;
  std::vector<std::uint8_t> isNew(positions_.size(), 0), isClose(positions_.size(), 0);
  for (const Index face : faces) {
    job.checkCancelled(0, 1);
    const auto [a, b, c] = vertices(face);
    if (isClose[a] != 0 && isClose[b] != 0 && isClose[c] != 0) continue;
    const auto corners = cornersOf(face);
    const Vec3f middle = (corners[0] + corners[1] + corners[2]) * (1.0f / 3);
    reached.clear();
    const auto reach = [&](Index f) {
      for (const Index v : vertices(f)) {
        if (seenFrom[v] == face) continue;
        seenFrom[v] = face;
        reached.push_back(v);
      }
      return true;
    };
    reach(face);
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const Index v = reached[i];
      isNew[v] = 1;
      const float away2 = squaredLength(positions_[v] - middle);
      if (away2 <= close2) isClose[v] = 1;
      if (away2 <= radius * radius) allAround(v, reach);
    }
  }
  heldShare_ = share;
  for (std::size_t v = 0; v < isNew.size(); ++v) {
    if (isNew[v] == 0) continue;
    if (share == 0 || (marks_[v] & kHeld) != 0) marks_[v] |= kFrozen;
    marks_[v] |= kHeld;
  }
}

void ReferenceMesh::releaseAll() {
  for (std::uint8_t& marks : marks_) marks &= kRough | kIsBent | kWays;
  heldShare_ = 1;
}

Index ReferenceMesh::locate(Index start, Vec3f p, Vec3f axis, int steps) const {
  Index face = start;
  for (int step = 0; step < steps && face != kNone; ++step) {
    Vec3f q[3];
    for (std::size_t i = 0; i < 3; ++i) q[i] = corner(face, i) - p;
    int out = -1;
    float worst = 0;
    for (int i = 0; i < 3; ++i) {
      const float side = dot(cross(q[(i + 1) % 3], q[(i + 2) % 3]), axis);
      if (side < worst) worst = side, out = i;
    }
    if (out < 0) return dot(cross(q[1] - q[0], q[2] - q[0]), axis) > 0 ? face : kNone;
    const Index c = opposite(3 * face + static_cast<Index>(out));
    face = c == kNone ? kNone : c / 3;
  }
  return kNone;
}

}  // namespace tufa::reduce
