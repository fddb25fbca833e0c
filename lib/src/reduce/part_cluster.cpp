// Contraction of clusters: all connected vertices of a cube become one in one operation.
//
// A fine mesh loses most of its vertices where many of them go into one. Collapses one after the
// other would test, for each of them, a star that the next one replaces. A contraction tests the
// last star alone, by the same guards: the cluster's triangles make a disk, the new star has the
// same border, and what is inside counts for nothing else. Cubes of eight voxels are tried first;
// where a cluster is refused, those of the cubes of half the size are (as in vertex clustering,
// Rossignac and Borrel 1993). What is left is for the queue. Places that are narrow, and vertices
// of borders and lines, are left to it altogether.
//
// Cost: 4 to 10 microseconds a contraction, which takes up to some 70 vertices.

#include <algorithm>
#include <cmath>

#include "base/bits.h"
#include "reduce/part.h"

namespace tufa::reduce {
namespace {

constexpr float kLeastCube = 2;  // voxels
constexpr int kHalvings = 2;     // from the largest cubes to these
// Squared sine of 1.4 degrees. Stars of high valence have thin triangles until their neighbours are
// contracted, too.
constexpr float kClusterSine2 = 6e-4f;

// Grows with the angle of a direction from the first axis, 0 to 4.
float turnOf(float x, float y) {
  const float share = x / (std::abs(x) + std::abs(y));
  return y < 0 ? 3 + share : 1 - share;
}

}  // namespace

void Part::contractClusters() {
  clusterOf_.assign(vertexCount_, 0);
  sortByCubes();
  nextCluster_ = 0;
  isContraction_ = true;
  contractRange(0, static_cast<Index>(cubes_.size()), kHalvings + 1);
  isContraction_ = false;
}

// Vertices by their cubes, in such an order that those of larger cubes follow each other, too.
void Part::sortByCubes() {
  cubes_.clear();
  for (Index v = 0; v < vertexCount_; ++v) {
    if (!isFree(v)) continue;
    std::uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      constexpr float kMiddle = 1 << 20;
      const float cell = std::floor(position_[v][axis] * (1 / kLeastCube));
      const float place = std::clamp(cell + kMiddle, 0.0f, 2 * kMiddle - 1);
      code |= base::spreadBits(static_cast<std::uint64_t>(place)) << axis;
    }
    cubes_.emplace_back(code, v);
  }
  std::sort(cubes_.begin(), cubes_.end());
}

// Contracts the clusters of the vertices in a range of cubes_. `halvings`: how often its cube can
// be halved still; one more than that of the largest cubes: a range of several of these.
void Part::contractRange(Index begin, Index end, int halvings) {
  if (halvings <= kHalvings && contractCube(begin, end)) return;
  if (halvings == 0) return;
  const int shift = 3 * (halvings - 1);
  while (begin < end) {
    const std::uint64_t cube = cubes_[begin].first >> shift;
    Index next = begin + 1;
    while (next < end && cubes_[next].first >> shift == cube) ++next;
    if (next - begin > 1) contractRange(begin, next, halvings - 1);
    begin = next;
  }
}

// Whether nothing is left to be tried in smaller cubes.
bool Part::contractCube(Index begin, Index end) {
  const auto vertexAt = [&](Index i) { return cubes_[i].second; };
  const Index open = ++nextCluster_;  // in the cube, in no cluster yet
  for (Index i = begin; i < end; ++i) {
    Index& cluster = clusterOf_[vertexAt(i)];
    if (cluster != kNone) cluster = open;
  }
  bool isAllDone = true;
  for (Index i = begin; i < end; ++i) {
    if (clusterOf_[vertexAt(i)] != open) continue;
    gatherCluster(vertexAt(i), open);
    if (cluster_.size() == 1) continue;
    const Outcome outcome = tryContraction();
    ++counts_.contractions[static_cast<std::size_t>(outcome)];
    if (outcome == Outcome::Done) {
      for (const Index v : cluster_) clusterOf_[v] = kNone;
    } else {
      isAllDone = false;
    }
  }
  return isAllDone;
}

// The vertices connected to one among those of its cube.
void Part::gatherCluster(Index first, Index open) {
  const Index own = ++nextCluster_;
  cluster_.assign(1, first);
  clusterOf_[first] = own;
  for (std::size_t i = 0; i < cluster_.size(); ++i) {
    const Index start = corner_[cluster_[i]];
    Index c = start;
    do {
      const Index v = vertex_[nextCorner(c)];
      if (clusterOf_[v] == open) {
        clusterOf_[v] = own;
        cluster_.push_back(v);
      }
      c = around(c);
    } while (c != start);
  }
}

Outcome Part::tryContraction() {
  if (done_ + cluster_.size() - 1 > limits_.quota) return Outcome::Place;
  Vec3f exact;
  if (!solveCluster(exact)) return Outcome::Sample;
  place_ = exact;
  if (!box_.hasInside(place_)) return Outcome::Place;
  if (!gatherClusterRing() || isNarrowRing()) return Outcome::Link;
  if (const std::size_t before = cluster_.size(); !fillNotches()) {
    return Outcome::Link;
  } else if (cluster_.size() > before) {
    if (!solveCluster(exact)) return Outcome::Sample;
    place_ = exact;
    if (!box_.hasInside(place_)) return Outcome::Place;
  }
  const Index nearest = nearestMember();
  if (hasLines_ && surface_->mayHold &&
      !surface_->mayHold(region_[at_[0] / 3], kNone, place_, position_[nearest],
                         position_[nearest])) {
    return Outcome::Place;
  }
  if (const Outcome o = clusterShapeGuard(); o != Outcome::Done) return o;
  if (!ringGuard()) return Outcome::Star;
  kept_ = cluster_[0];
  ++now_;  // samples taken in an attempt before are not taken
  if (const Outcome o = clusterDistanceGuard(nearest); o != Outcome::Done) return o;
  if (!sideGuard()) return Outcome::Side;
  sum_.moveBy(place_ - exact);
  applyContraction();
  done_ += static_cast<Index>(cluster_.size() - 1);
  return Outcome::Done;
}

// The quadric of all members, seen from its least place. Whether the error there is small enough.
bool Part::solveCluster(Vec3f& place) {
  Vec3f middle;
  for (const Index v : cluster_) middle = middle + position_[v];
  middle = middle * (1 / static_cast<float>(cluster_.size()));
  sum_ = {};
  float radius2 = 0;
  for (const Index v : cluster_) {
    LocalQuadric own = quadric_[v];
    own.moveBy(middle - position_[v]);
    sum_ += own;
    radius2 = std::max(radius2, squaredLength(position_[v] - middle));
  }
  Vec3f off = sum_.minimum();
  if (!(squaredLength(off) <= radius2)) off = {};
  place = middle + off;
  const float most = limits_.errorShare * limits_.distance;
  if (!(sum_.at(off) <= most * most * sum_.weight)) return false;
  sum_.moveBy(off);
  return true;
}

Index Part::nearestMember() const {
  return *std::min_element(cluster_.begin(), cluster_.end(), [&](Index a, Index b) {
    return squaredLength(position_[a] - place_) < squaredLength(position_[b] - place_);
  });
}

// The ring around the cluster, if its triangles make a disk. A disk with k vertices inside and m on
// its border has m + 2 (k - 1) triangles; with a hole or a handle it has more. A triangle with one
// member is at the ring, one with several vanishes.
bool Part::gatherClusterRing() {
  ++mergedNow_;
  for (const Index v : cluster_) merged_[v] = mergedNow_;
  vanishing_.clear();
  Index first = kNone, atRing = 0;
  for (const Index v : cluster_) {
    const Index start = corner_[v];
    Index c = start;
    do {
      const Index x = vertex_[nextCorner(c)], y = vertex_[previousCorner(c)];
      const bool isX = isMerged(x), isY = isMerged(y);
      if (!isX && !isY) {
        first = c, ++atRing;
      } else if ((!isX || v < x) && (!isY || v < y)) {
        vanishing_.push_back(c / 3);  // once, from its lowest member
      }
      c = around(c);
    } while (c != start);
  }
  if (first == kNone || vanishing_.size() != 2 * (cluster_.size() - 1)) return false;
  size_ = 0;
  flip_[0] = kNone;
  ringStamp_ = ++now_;
  Index c = first;
  do {
    if (!addToRing(c)) return false;
    // Around the end of this edge of the ring, from member to member, to the next edge.
    Index e = c;
    for (;;) {
      e = around(e);
      if (!isMerged(vertex_[previousCorner(e)])) break;
      e = previousCorner(e);
    }
    c = e;
  } while (c != first);
  ring_[size_] = ring_[0];
  split_ = size_;
  return size_ >= 3 && static_cast<Index>(size_) == atRing;
}

bool Part::isNarrowRing() const {
  return std::any_of(ring_, ring_ + size_, [&](Index v) { return (flags_[v] & kNarrow) != 0; });
}

// Takes in vertices of the ring where it runs towards the place or back, as it may between cubes:
// the triangles there would be needles. Whether there still is a ring that can be taken.
bool Part::fillNotches() {
  constexpr int kMostTimes = 3;
  for (int i = 0; i < kMostTimes; ++i) {
    const Vec3f axis = axis_[nearestMember()];
    const std::size_t before = cluster_.size();
    Vec3f at = position_[ring_[size_ - 1]] - place_;
    for (int k = 0; k < size_; ++k) {
      const Vec3f last = at;
      at = position_[ring_[k]] - place_;
      const float turn = dot(cross(last, at), axis);
      const float a2 = squaredLength(last), b2 = squaredLength(at);
      if (turn > 0 && turn * turn > kClusterSine2 * a2 * b2) continue;
      const Index nearer = ring_[a2 < b2 ? (k == 0 ? size_ : k) - 1 : k];
      if (isFree(nearer) && !isMerged(nearer)) {
        merged_[nearer] = mergedNow_;
        cluster_.push_back(nearer);
      }
    }
    if (cluster_.size() == before) break;
    if (!gatherClusterRing() || isNarrowRing()) return false;
  }
  return true;
}

// The new star is a graph that its border winds around once, without folds and needles, and no
// triangle at the ring turns far.
Outcome Part::clusterShapeGuard() {
  if (!makeStar() || !isGraph_ || !windsInFrame()) return Outcome::Flat;
  if (sharpestAfter().least() < kFoldCosine) return Outcome::Fold;
  for (int i = 0; i < size_; ++i) {
    const Vec3f old = position_[vertex_[at_[i]]] - place_, x = spoke_[i], y = spoke_[i + 1];
    const Vec3f was = cross(x - old, y - old);
    const float turn = dot(normal_[i], was);
    if (turn <= 0 || turn * turn < limits_.turnCosine * limits_.turnCosine * squaredLength(was)) {
      return Outcome::Turn;
    }
    const float now = leastSine2(squaredLength(cross(x, y)), squaredLength(x), squaredLength(y),
                                 squaredLength(y - x));
    if (now < kClusterSine2) return Outcome::Round;
  }
  return Outcome::Done;
}

// As distanceGuard().
Outcome Part::clusterDistanceGuard(Index nearest) {
  clearTaken();
  if (reference_->isScaled()) {
    std::vector<Index> triangles = vanishing_;
    for (int i = 0; i < size_; ++i) triangles.push_back(at_[i] / 3);
    if (!scaleTolerance(triangles, nearest)) return Outcome::Sample;
  }
  for (int i = 0; i < size_; ++i) turns_[i] = turnOf(z_[i].x, z_[i].y);
  first_ = static_cast<int>(std::min_element(turns_, turns_ + size_) - turns_);
  std::rotate(turns_, turns_ + first_, turns_ + size_);
  for (int i = 0; i < size_; ++i) {
    if (!clusterSamplesNear(at_[i] / 3)) return Outcome::Sample;
  }
  for (const Index t : vanishing_) {
    if (!clusterSamplesNear(t)) return Outcome::Sample;
  }
  if (!apexNear(nearest, nearest)) return Outcome::Apex;
  if (!crossingsNear()) return Outcome::Crossing;
  return facesNear() ? Outcome::Done : Outcome::Face;
}

// As samplesNear(); the new triangle of a sample is found by its angle.
bool Part::clusterSamplesNear(Index t) {
  for (Index s = firstSample_[t]; s != kNone; s = samples_[s].next) {
    const Vec3f p = samples_[s].p - place_;
    if (!isGraph_) {
      if (!sampleNearStar(s, p)) return false;
      continue;
    }
    const Vec3f q = inFrame(p);
    const float* const next = std::upper_bound(turns_, turns_ + size_, turnOf(q.x, q.y));
    const auto after = static_cast<int>(next - turns_);
    const int wedge = (first_ + (after == 0 ? size_ : after) - 1) % size_;
    if (!sampleNearGraph(s, q, wedge)) return false;
  }
  return true;
}

void Part::applyContraction() {
  for (int i = 0; i < size_; ++i) {
    const Index c = at_[i], next = at_[i + 1 == size_ ? 0 : i + 1];
    vertex_[c] = kept_;
    corner_[ring_[i]] = nextCorner(c);
    emptySamples(c / 3);
    opposite_[nextCorner(c)] = previousCorner(next);
    opposite_[previousCorner(next)] = nextCorner(c);
  }
  for (const Index t : vanishing_) {
    vertex_[3 * t] = vertex_[3 * t + 1] = vertex_[3 * t + 2] = kNone;
    emptySamples(t);
  }
  giveSamples();
  corner_[kept_] = at_[0];
  position_[kept_] = place_, quadric_[kept_] = sum_, face_[kept_] = apexFace_;
  axis_[kept_] = isGraph_ ? n_ : Vec3f();
  moved_[kept_] = 1;
  for (int i = 0; i < newAxes_; ++i) axis_[newAxis_[i].vertex] = newAxis_[i].axis;
}

}  // namespace tufa::reduce
