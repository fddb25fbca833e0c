#include "octree/patch.h"

#include <algorithm>
#include <numbers>

namespace tufa::octree {

using uniform::kCorners;
using uniform::kEdges;
using uniform::kFaces;

namespace {

constexpr std::uint32_t kNotNumbered = ~std::uint32_t{0};

// Where an edge lies on the two axes it does not run along: bit 1 for the first, bit 0 for the
// second.
constexpr int sideOfEdge(int edge) { return edge & 3; }

// The same two bits of a child's position.
constexpr int sideOfChild(int child, int axis) {
  const auto [u, v] = uniform::otherAxes(axis);
  return ((child >> (2 - u)) & 1) << 1 | ((child >> (2 - v)) & 1);
}

// Pairs of edges that coincide where two cells share a face across `axis`: one of the upper face of
// the lower cell, one of the lower face of the upper cell.
struct SharedEdge {
  int ofLower, ofUpper;
};
constexpr auto kSharedEdges = [] {
  std::array<std::array<SharedEdge, 4>, 3> all{};
  for (int axis = 0; axis < 3; ++axis) {
    int count = 0;
    for (int edge = 0; edge < kEdges; ++edge) {
      const int along = edge / 4;
      if (along == axis) continue;
      const int bit = uniform::otherAxes(along)[0] == axis ? 2 : 1;
      if ((edge & bit) != 0) all[axis][count++] = {edge, edge & ~bit};
    }
  }
  return all;
}();

double angleBetween(const Vec3& a, const Vec3& b) {
  const double lengths = std::sqrt(a.squaredLength() * b.squaredLength());
  return lengths > 0 ? std::acos(std::clamp(a.dot(b) / lengths, -1.0, 1.0)) : std::numbers::pi;
}

// The Euler characteristic is summed times 4, so that all terms are integers: each patch adds 1; a
// curve on a face between children takes 1 off and is found at both its ends; a crossing on a line
// from the middle adds 1 and is found in four children.
constexpr int kPerPatch = 4, kPerSharedCrossing = -2, kPerInnerCrossing = 1, kDisk = 4;

// Whether the patch has none or two crossings around each face of its cell, and three at least.
bool meetsFacesOnce(const Patch& patch) {
  int total = 0;
  std::array<int, kFaces> around{};
  for (int edge = 0; edge < kEdges; ++edge) {
    if (patch.crossings[edge] == Patch::kNoCrossing) continue;
    ++total;
    const auto [u, v] = uniform::otherAxes(edge / 4);
    ++around[u * 2 + ((edge >> 1) & 1)];
    ++around[v * 2 + (edge & 1)];
  }
  return total >= 3 &&
         std::all_of(around.begin(), around.end(), [](int n) { return n == 0 || n == 2; });
}

}  // namespace

void NormalCone::add(const NormalCone& other) {
  if (axis.squaredLength() == 0 && angle == 0) {  // of nothing; not of normals that cancel out
    *this = other;
    return;
  }
  const Vec3 sum = axis + other.axis;
  angle = std::min(
      std::max(angle + angleBetween(axis, sum), other.angle + angleBetween(other.axis, sum)),
      std::numbers::pi);
  axis = sum;
}

std::uint32_t PatchJoiner::root(std::uint32_t patch) {
  while (parents_[patch] != patch) patch = parents_[patch] = parents_[parents_[patch]];
  return patch;
}

void PatchJoiner::joinAcross(const Children& children, int lower, int upper, int axis) {
  for (std::uint32_t a = 0; a < children[lower].size(); ++a) {
    const Patch& below = children[lower][a];
    for (std::uint32_t b = 0; b < children[upper].size(); ++b) {
      const Patch& above = children[upper][b];
      int shared = 0;
      for (const SharedEdge& edge : kSharedEdges[axis]) {
        const std::int32_t at = below.crossings[edge.ofLower];
        shared += at != Patch::kNoCrossing && at == above.crossings[edge.ofUpper] ? 1 : 0;
      }
      if (shared == 0) continue;
      const std::uint32_t i = root(first_[lower] + a), j = root(first_[upper] + b);
      const std::uint32_t keep = std::min(i, j), drop = std::max(i, j);
      if (keep != drop) {
        parents_[drop] = keep;
        shared_[keep] += shared_[drop];
      }
      shared_[keep] += shared;
    }
  }
}

// Takes over those crossings of a child that lie on edges of the cell. False if the patch has one
// on the same edge already: it would pass that edge twice.
bool PatchJoiner::addCrossings(Patch& patch, const Patch& child, int position) {
  for (int edge = 0; edge < kEdges; ++edge) {
    if (child.crossings[edge] == Patch::kNoCrossing) continue;
    if (sideOfChild(position, edge / 4) != sideOfEdge(edge)) continue;
    if (patch.crossings[edge] != Patch::kNoCrossing) return false;
    patch.crossings[edge] = child.crossings[edge];
  }
  return true;
}

bool PatchJoiner::join(const Children& children) {
  std::uint32_t count = 0;
  for (int child = 0; child < kCorners; ++child) {
    first_[child] = count;
    count += static_cast<std::uint32_t>(children[child].size());
  }
  first_[kCorners] = count;
  parents_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) parents_[i] = i;
  shared_.assign(count, 0);
  for (int axis = 0; axis < 3; ++axis) {
    for (int lower = 0; lower < kCorners; ++lower) {
      const int step = 1 << (2 - axis);
      if ((lower & step) == 0) joinAcross(children, lower, lower | step, axis);
    }
  }
  // The root of a patch is its least member. Curves are counted at roots already; here each child
  // patch and each of its crossings on the lines from the middle is added to its root.
  patches_.clear();
  sums_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) sums_[i] = kPerSharedCrossing * shared_[i];
  int position = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    while (i >= first_[position + 1]) ++position;
    const Patch& child = children[position][i - first_[position]];
    const std::uint32_t top = root(i);
    sums_[top] += kPerPatch;
    for (int edge = 0; edge < kEdges; ++edge) {
      const bool inner = (sideOfChild(position, edge / 4) ^ sideOfEdge(edge)) == 3;
      if (inner && child.crossings[edge] != Patch::kNoCrossing) sums_[top] += kPerInnerCrossing;
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    if (parents_[i] == i && sums_[i] != kDisk) return false;
  }
  // Each root becomes a patch of the cell, numbered by its least member, which makes the order
  // independent of the order of the joins.
  numbers_.assign(count, kNotNumbered);
  position = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    while (i >= first_[position + 1]) ++position;
    std::uint32_t& number = numbers_[root(i)];
    if (number == kNotNumbered) {
      number = static_cast<std::uint32_t>(patches_.size());
      patches_.emplace_back();
    }
    if (!addCrossings(patches_[number], children[position][i - first_[position]], position)) {
      return false;
    }
  }
  // From the last to the first: a root has the least index of its members, and must still be a root
  // when they are looked up.
  for (std::uint32_t i = count; i-- > 0;) parents_[i] = numbers_[root(i)];
  return std::all_of(patches_.begin(), patches_.end(), meetsFacesOnce);
}

}  // namespace tufa::octree
