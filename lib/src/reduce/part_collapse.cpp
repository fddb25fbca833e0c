// Edge collapse: from a candidate to an operation that is made.

#include <algorithm>

#include "reduce/part.h"

namespace tufa::reduce {

void Part::collapseAll() {
  countSlivers();
  proposeAll();
  collapseProposed();
  if (limits_.lines == LineMode::Free && contractKnots()) collapseProposed();
}

void Part::proposeAll() {
  for (Index c = 0; c < 3 * triangleCount_; ++c) {
    if (isDead(c / 3)) continue;
    const Index a = vertex_[nextCorner(c)], b = vertex_[previousCorner(c)];
    if (a < b || opposite_[c] == kNone) propose(a, b);
  }
}

void Part::collapseProposed() {
  Candidate e;
  while (pop(e)) {
    if (version_[e.a] != e.versionA || version_[e.b] != e.versionB) continue;
    if (done_ >= limits_.quota) {
      ++counts_.overQuota;
      continue;  // until the queue is empty
    }
    pollAttempt();
    const Outcome outcome = tryCollapse(e.a, e.b);
    ++counts_.collapses[static_cast<std::size_t>(outcome)];
    done_ += outcome == Outcome::Done;
  }
}

void Part::countSlivers() {
  alive_ = sliverCount_ = 0;
  for (Index t = 0; t < triangleCount_; ++t) {
    if (isDead(t)) continue;
    Vec3f p[3];
    triangleAt(t, p);
    const Vec3f x = p[1] - p[0], y = p[2] - p[0];
    ++alive_;
    sliverCount_ += leastSine2(squaredLength(cross(x, y)), squaredLength(x), squaredLength(y),
                               squaredLength(p[2] - p[1])) < limits_.leastSine2;
  }
}

// The quadric of both ends, seen from its least place. Returns its error there.
float Part::solve(Index a, Index b, Vec3f& place, LocalQuadric& sum) const {
  const Vec3f middle = (position_[a] + position_[b]) * 0.5f;
  sum = quadric_[a];
  sum.moveBy(middle - position_[a]);
  LocalQuadric other = quadric_[b];
  other.moveBy(middle - position_[b]);
  sum += other;
  Vec3f off = sum.minimum();
  if (!(squaredLength(off) <= squaredLength(position_[a] - position_[b]))) off = {};
  place = middle + off;
  const float error = std::max(0.0f, sum.at(off));
  sum.moveBy(off);
  return error;
}

void Part::propose(Index a, Index b) {
  if (inner_[a] == 0 || inner_[b] == 0) return;
  if (isAlone() && !isNearLine(a) && !isNearLine(b)) return;
  Vec3f place;
  LocalQuadric sum;
  float error = solve(a, b, place, sum);
  if (isOnLine(a) || isOnLine(b) || isAlone()) error = errorAtLine(a, b, place, sum);
  const float most = limits_.errorShare * limits_.distance;
  if (!(error <= most * most * sum.weight)) return;
  // Among edges of flat surface the short ones come first.
  constexpr float kCostOfLength = 3e-5f;
  push(error + kCostOfLength * squaredLength(position_[a] - position_[b]),
       {a, b, version_[a], version_[b]});
}

// The place of least quadric error first. Beside creases and slivers that can fold a triangle where
// one of the two old places does not: those are next.
Outcome Part::tryCollapse(Index a, Index b) {
  if (isOnLine(a) || isOnLine(b) || isAlone()) return tryCollapseAtLine(a, b);
  Vec3f exact;
  solve(a, b, exact, sum_);
  if (!gatherRing(a, b)) return Outcome::Link;
  Outcome outcome = tryPlace(a, b, exact);
  const bool isFar =
      outcome == Outcome::Sample || outcome == Outcome::Apex || outcome == Outcome::Crossing;
  if (outcome != Outcome::Done && (limits_.allPlaces || !isFar)) {
    const float most = limits_.errorShare * limits_.distance;
    const float worst = most * most * sum_.weight;
    const float errorA = sum_.at(position_[a] - exact), errorB = sum_.at(position_[b] - exact);
    const Index first = errorA <= errorB ? a : b, second = errorA <= errorB ? b : a;
    if (std::min(errorA, errorB) <= worst) outcome = tryPlace(a, b, position_[first]);
    if (outcome != Outcome::Done && std::max(errorA, errorB) <= worst) {
      outcome = tryPlace(a, b, position_[second]);
    }
  }
  if (outcome != Outcome::Done) return outcome;
  sum_.moveBy(place_ - exact);
  apply(a, b);
  for (int i = 0; i < size_; ++i) propose(a, ring_[i]);
  return Outcome::Done;
}

Outcome Part::tryPlace(Index a, Index b, Vec3f place) {
  place_ = place;
  ++now_;  // samples taken in an attempt before are not taken
  if (!box_.hasInside(place_)) return Outcome::Place;
  if (hasLines_ && !mayHold(a, b)) return Outcome::Place;
  if (const Outcome o = shapeGuard(a, b); o != Outcome::Done) return o;
  const Index merged[] = {a, b}, vanishing[] = {left_ / 3, right_ / 3};
  if (isOn(Outcome::Fold) && !foldGuard(merged)) return Outcome::Fold;
  if (!ringGuard() && isOn(Outcome::Star)) return Outcome::Star;
  if (const Outcome o = distanceGuard(a, b); o != Outcome::Done) return o;
  if (isOn(Outcome::Intersection) && starIntersects(merged)) return Outcome::Intersection;
  if (isOn(Outcome::Side) && (!sideGuard() || passesOver(merged, vanishing))) return Outcome::Side;
  return Outcome::Done;
}

bool Part::addToRing(Index c) {
  const Index z = vertex_[nextCorner(c)];
  if (stamp_[z] == now_ || size_ >= kMostRing - 1) return false;
  stamp_[z] = now_;
  ring_[size_] = z, at_[size_] = c, ++size_;
  return true;
}

// The link condition holds if and only if no vertex is met twice: a common neighbour of a and b
// other than the two across their edge would be.
bool Part::gatherRing(Index a, Index b) {
  size_ = split_ = 0;
  kept_ = a, gone_ = b, flip_[0] = kNone;
  merged_[a] = merged_[b] = ++mergedNow_;
  ringStamp_ = ++now_;
  Index c = corner_[a];
  int valenceA = 1, valenceB = 0;
  for (int steps = 0; vertex_[nextCorner(c)] != b; c = around(c)) {
    if (++steps > kMostRing) return false;
  }
  left_ = c;
  for (c = around(left_); vertex_[previousCorner(c)] != b; c = around(c), ++valenceA) {
    if (!addToRing(c)) return false;
  }
  right_ = c;
  split_ = size_;
  const Index leftAtB = nextCorner(left_);
  for (c = around(previousCorner(right_)); c != leftAtB; c = around(c), ++valenceB) {
    if (!addToRing(c)) return false;
  }
  ring_[size_] = ring_[0];
  return size_ >= 3 && split_ > 0 && split_ < size_ &&
         size_ <= std::max({limits_.mostValence, valenceA + 1, valenceB + 2});
}

void Part::apply(Index a, Index b) {
  for (int i = split_; i < size_; ++i) vertex_[at_[i]] = a;
  const auto stitch = [&](Index c, Index d) { opposite_[c] = d, opposite_[d] = c; };
  stitch(opposite_[left_], opposite_[nextCorner(left_)]);
  stitch(opposite_[right_], opposite_[previousCorner(right_)]);
  for (const Index t : {left_ / 3, right_ / 3}) {
    vertex_[3 * t] = vertex_[3 * t + 1] = vertex_[3 * t + 2] = kNone;
    emptySamples(t);
    if (hasBoxList_) boxList_.remove(t, boxSlots_);
  }
  corner_[a] = at_[0];
  for (int i = 0; i < size_; ++i) {
    corner_[ring_[i]] = nextCorner(at_[i]);
    emptySamples(at_[i] / 3);
  }
  giveSamples();
  position_[a] = place_, quadric_[a] = sum_, face_[a] = apexFace_;
  axis_[a] = isGraph_ ? n_ : Vec3f();
  flags_[a] = static_cast<std::uint8_t>(flags_[a] | flags_[b]);
  for (int i = 0; i < newAxes_; ++i) axis_[newAxis_[i].vertex] = newAxis_[i].axis;
  alive_ -= 2, sliverCount_ += newSlivers_;
  ++version_[a], ++version_[b];
  moved_[a] = 1;
  if (hasBoxList_) {
    for (int i = 0; i < size_; ++i) renewBox(at_[i] / 3);
  }
}

}  // namespace tufa::reduce
