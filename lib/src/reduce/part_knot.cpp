// Contraction of knots: vertices that stand close together, most of them on a crease that passes by
// a sample, and whose triangles are thin and may be folded over each other.
//
// A star inside a knot is no graph, so that none of its edges can be collapsed alone. All its
// vertices at once can become one: what is inside the ring of a contraction counts for nothing. As
// knots lie where the reference is rough and narrow, all guards of a collapse are asked.
//
// Cost: 5 to 20 microseconds a knot; there are some for each edge of a solid.

#include <algorithm>
#include <array>

#include "reduce/part.h"

namespace tufa::reduce {
namespace {

constexpr float kShort = 0.25f;                          // voxels: an edge of a knot
constexpr std::array kRadii = {0.2f, 0.4f, 0.8f, 1.6f};  // around a vertex of it, voxels
constexpr std::size_t kMostMembers = 32;

}  // namespace

// Whether there was one.
bool Part::contractKnots() {
  wasInKnot_.assign(vertexCount_, 0);
  bool any = false;
  isContraction_ = true;
  for (Index c = 0; c < 3 * triangleCount_; ++c) {
    if (isDead(c / 3)) continue;
    const Index a = vertex_[nextCorner(c)], b = vertex_[previousCorner(c)];
    if (a > b || squaredLength(position_[a] - position_[b]) > kShort * kShort) continue;
    if (wasInKnot_[a] == 0) any |= contractKnot(a);
  }
  isContraction_ = false;
  if (any) countSlivers();
  return any;
}

bool Part::contractKnot(Index v) {
  std::size_t before = 2;  // which a collapse has tried
  for (const float radius : kRadii) {
    gatherKnot(v, radius);
    if (cluster_.size() > kMostMembers) break;
    if (cluster_.size() <= before) continue;
    before = cluster_.size();
    for (const Index member : cluster_) wasInKnot_[member] = 1;
    const Outcome outcome = tryKnot();
    ++counts_.knots[static_cast<std::size_t>(outcome)];
    if (outcome == Outcome::Done) return true;
  }
  return false;
}

// The vertices connected to one within a radius, as far as they may move.
void Part::gatherKnot(Index v, float radius) {
  cluster_.clear();
  const auto mayGo = [&](Index at) {
    return inner_[at] != 0 && (flags_[at] & kBorder) == 0 && !isOnLine(at);
  };
  if (!mayGo(v)) return;
  ++mergedNow_;
  cluster_.push_back(v);
  merged_[v] = mergedNow_;
  for (std::size_t i = 0; i < cluster_.size() && cluster_.size() <= kMostMembers; ++i) {
    const Index start = corner_[cluster_[i]];
    Index c = start;
    do {
      const Index next = vertex_[nextCorner(c)];
      if (!isMerged(next) && mayGo(next) &&
          squaredLength(position_[next] - position_[v]) <= radius * radius) {
        merged_[next] = mergedNow_;
        cluster_.push_back(next);
      }
      c = around(c);
    } while (c != start);
  }
}

Outcome Part::tryKnot() {
  const Outcome outcome = [&] {
    if (done_ + cluster_.size() - 1 > limits_.quota) return Outcome::Place;
    Vec3f exact;
    if (!solveCluster(exact)) return Outcome::Sample;
    place_ = exact;
    if (!box_.hasInside(place_)) return Outcome::Place;
    if (!gatherClusterRing() || size_ > limits_.mostValence) return Outcome::Link;
    kept_ = cluster_[0];
    const Index nearest = nearestMember();
    if (hasLines_ && surface_->mayHold &&
        !surface_->mayHold(region_[at_[0] / 3], kNone, place_, position_[nearest],
                           position_[nearest])) {
      return Outcome::Place;
    }
    ++now_;  // samples taken in an attempt before are not taken
    if (!makeStar()) return Outcome::Flat;
    if (!(isGraph_ ? windsInFrame() : isSimpleStar(cluster_))) return Outcome::Flat;
    if (const Outcome o = knotShapeGuard(); o != Outcome::Done) return o;
    if (!foldGuard(cluster_)) return Outcome::Fold;
    if (!ringGuard()) return Outcome::Star;
    if (const Outcome o = clusterDistanceGuard(nearest); o != Outcome::Done) return o;
    if (starIntersects(cluster_)) return Outcome::Intersection;
    if (!sideGuard() || passesOver(cluster_, vanishing_)) return Outcome::Side;
    sum_.moveBy(place_ - exact);
    return Outcome::Done;
  }();
  if (outcome == Outcome::Done) applyKnot();
  return outcome;
}

// No triangle at the ring turns far, unless it was a sliver or folded over, and there are no more
// slivers than before, or fewer if they are sharper.
Outcome Part::knotShapeGuard() {
  const auto sineOf = [](Vec3f x, Vec3f y) {
    return leastSine2(squaredLength(cross(x, y)), squaredLength(x), squaredLength(y),
                      squaredLength(y - x));
  };
  int slivers = 0;
  float after = 1, before = 1;
  for (int i = 0; i < size_; ++i) {
    const Vec3f old = position_[vertex_[at_[i]]] - place_, x = spoke_[i], y = spoke_[i + 1];
    const Vec3f was = cross(x - old, y - old);
    const float area2 = squaredLength(was), turn = dot(normal_[i], was), along = dot(was, n_);
    const float then = sineOf(x - old, y - old), now = sineOf(x, y);
    const bool keeps = turn > 0 && turn * turn >= limits_.turnCosine * limits_.turnCosine * area2;
    const bool wasFolded =
        isGraph_ && (along < 0 || along * along < kLeastCosine * kLeastCosine * area2);
    if (!keeps && then > kWorstSine2 && area2 > kTinyFace2 && !wasFolded) return Outcome::Turn;
    after = std::min(after, now), before = std::min(before, then);
    slivers += (now < limits_.leastSine2) - (then < limits_.leastSine2);
  }
  for (const Index t : vanishing_) {
    Vec3f p[3];
    triangleAt(t, p);
    const float then = sineOf(p[1] - p[0], p[2] - p[0]);
    before = std::min(before, then);
    slivers -= then < limits_.leastSine2;
  }
  if (after >= limits_.leastSine2 || (slivers <= 0 && after >= kWorstSine2)) return Outcome::Done;
  return slivers < 0 && after >= kSharper2 * before ? Outcome::Done : Outcome::Round;
}

void Part::applyKnot() {
  unsigned all = 0;
  for (const Index v : cluster_) all |= flags_[v], ++version_[v];
  applyContraction();
  flags_[kept_] = static_cast<std::uint8_t>(all);
  if (hasBoxList_) {
    for (const Index t : vanishing_) boxList_.remove(t, boxSlots_);
    for (int i = 0; i < size_; ++i) renewBox(at_[i] / 3);
  }
  done_ += static_cast<Index>(cluster_.size() - 1);
  for (int i = 0; i < size_; ++i) propose(kept_, ring_[i]);
}

}  // namespace tufa::reduce
