// Edge flips: they make slivers rounder and free collapses on flat faces.

#include <algorithm>

#include "reduce/component_size.h"
#include "reduce/part.h"

namespace tufa::reduce {
namespace {

constexpr int kPasses = 3;
constexpr float kFlipSine2 = 0.18f;  // squared sine of 25 degrees: larger angles are left alone
constexpr float kBetter = 1.2f;      // by this factor the squared sine must grow
constexpr float kFlipTurnCosine = 0.9f;
constexpr float kFlipFoldCosine = -0.5f;
constexpr float kLeastFlipLength = 1e-6f;
constexpr float kNeedleSine2 = 1e-4f;  // of 0.6 degrees: worth a second walk

}  // namespace

void Part::flipAll() {
  for (int pass = 0; pass < kPasses; ++pass) {
    bool isAny = false;
    for (Index c = 0; c < 3 * triangleCount_; ++c) {
      if (isDead(c / 3) || opposite_[c] == kNone || opposite_[c] < c) continue;
      pollAttempt();
      const Outcome outcome = tryFlip(c);
      ++counts_.flips[static_cast<std::size_t>(outcome)];
      isAny |= outcome == Outcome::Done;
    }
    if (!isAny) break;
  }
}

// Corner c is at v[0], its opposite edge runs from v[1] to v[2]; the corner across is at v[3].
// Triangles (v0, v1, v2) and (v3, v2, v1) become (v0, v1, v3) and (v3, v2, v0).
Outcome Part::tryFlip(Index c) {
  const Index d = opposite_[c];
  const Index v[4] = {vertex_[c], vertex_[nextCorner(c)], vertex_[previousCorner(c)], vertex_[d]};
  for (const Index i : v) {
    if (inner_[i] == 0) return Outcome::Place;
  }
  if (hasLines_ && (isLineEdge(c) || !mayFlipAtLine(v))) return Outcome::Place;
  const Vec3f y = position_[v[0]], u = position_[v[1]], w = position_[v[2]], x = position_[v[3]];
  const float before = std::min(leastSine2(y, u, w), leastSine2(x, w, u));
  const float aim = limits_.keepsAngle() ? std::max(kFlipSine2, limits_.leastSine2) : kFlipSine2;
  if (before > aim) return Outcome::Worthless;
  const float after = std::min(leastSine2(y, u, x), leastSine2(x, w, y));
  if (!(after > kBetter * before + 1e-6f)) return Outcome::Worthless;
  const Vec3f n0 = cross(u - y, x - y), n1 = cross(w - x, y - x);
  const float l0 = length(n0), l1 = length(n1);
  if (!(l0 > kLeastFlipLength && l1 > kLeastFlipLength)) return Outcome::Flat;
  const Vec3f n[2] = {n0 * (1 / l0), n1 * (1 / l1)};
  const Vec3f o0 = cross(u - y, w - y), o1 = cross(w - x, u - x);
  // What turns that far at the edge is a shape of the solid, which would be lost.
  if (dot(o0, o1) < 0 && std::min(squaredLength(o0), squaredLength(o1)) > kTinyFace2) {
    return Outcome::Turn;
  }
  const Vec3f old = unit(o0 + o1);
  if (!(dot(n[0], n[1]) >= kFlipTurnCosine && dot(n[0], old) >= kFlipTurnCosine &&
        dot(n[1], old) >= kFlipTurnCosine)) {
    return Outcome::Turn;
  }
  flip_[0] = c, flip_[1] = d, ringStamp_ = ++now_;
  for (const Index i : v) stamp_[i] = now_;
  if (!flipStars(v, n)) return Outcome::Star;
  n_ = unit(n[0] + n[1]);
  if (!flipDistance(v, before < kNeedleSine2)) return Outcome::Crossing;
  if (flipIntersects(v)) return Outcome::Intersection;
  if (isOn(Outcome::Side) && (!flipKeepsSide(v) || flipPassesOver(v))) return Outcome::Side;
  applyFlip(v);
  return Outcome::Done;
}

// Valences, the new edge's absence, folds across the four outer edges, and the four stars.
bool Part::flipStars(const Index* v, const Vec3f* n) {
  int valence[4] = {};
  for (int k = 0; k < 4; ++k) {
    Index at = corner_[v[k]];
    do {
      ++valence[k];
      if (k == 0 && vertex_[nextCorner(at)] == v[3]) return false;
      at = around(at);
    } while (at != corner_[v[k]]);
  }
  if (valence[1] <= 3 || valence[2] <= 3) return false;
  if (std::max(valence[0], valence[3]) >= limits_.mostValence) return false;
  const Index c = flip_[0], d = flip_[1];
  // Edges (v0, v1) and (v1, v3) of the first new triangle, (v2, v0) and (v3, v2) of the second.
  const Index outer[4] = {previousCorner(c), nextCorner(d), nextCorner(c), previousCorner(d)};
  for (int k = 0; k < 4; ++k) {
    const Vec3f m = outerNormal(outer[k]);
    if (squaredLength(m) > kTinyFace2 && dot(n[k / 2], m) < kFlipFoldCosine * length(m)) {
      return false;
    }
  }
  newAxes_ = 0;
  for (int k = 0; k < 4; ++k) {
    const bool inFirst = k != 2, inSecond = k != 1;
    const Vec3f axis = axis_[v[k]];
    if ((!inFirst || dot(axis, n[0]) >= kLeastCosine) &&
        (!inSecond || dot(axis, n[1]) >= kLeastCosine)) {
      continue;
    }
    if (!starGuard(v[k], linkAfterFlip(v, k))) return false;
  }
  return true;
}

// The neighbours of v[k] without the lost edge or with the new one.
Part::Link Part::linkAfterFlip(const Index* v, int k) const {
  Link link;
  Index c = corner_[v[k]];
  do {
    const Index next = vertex_[nextCorner(c)];
    const bool isLost = (k == 1 && next == v[2]) || (k == 2 && next == v[1]);
    if (isLost) {
      link.changed = link.count;
    } else {
      link.add(position_[next] - position_[v[k]]);
    }
    if ((k == 0 && next == v[1]) || (k == 3 && next == v[2])) {
      link.changed = link.count;
      link.add(position_[v[3 - k]] - position_[v[k]]);
    }
    c = around(c);
  } while (c != corner_[v[k]] && link.count < kMostRing - 1);
  if (c != corner_[v[k]]) return {};
  if (k == 1 || k == 2) link.changed = link.changed % link.count;
  return link;
}

bool Part::flipDistance(const Index* v, bool isNeedle) {
  const Vec3f y = position_[v[0]], u = position_[v[1]], w = position_[v[2]], x = position_[v[3]];
  const Index t0 = flip_[0] / 3, t1 = flip_[1] / 3;
  clearTaken();
  const std::array<Index, 2> both{t0, t1};
  if (reference_->isScaled() && !scaleTolerance(both, v[0])) return false;
  for (const Index t : both) {
    for (Index s = firstSample_[t]; s != kNone; s = samples_[s].next) {
      const Vec3f p = samples_[s].p;
      const float d0 = squaredDistanceToTriangle(p, y, u, x);
      const float d1 = squaredDistanceToTriangle(p, x, w, y);
      if (!(std::min(d0, d1) <= squaredDistance_) && isOn(Outcome::Sample)) return false;
      taken_.push_back({s, d0 <= d1 ? t0 : t1});
    }
  }
  // Where vertices crowd on a crease a walk can end among faces without area. Another one goes the
  // other way, for the sake of needles only.
  if (!flippedEdgeNear(v[0], v[3]) && !(isNeedle && flippedEdgeNear(v[3], v[0]))) return false;
  return !isOn(Outcome::Face) || facesNear();
}

bool Part::flippedEdgeNear(Index from, Index to) {
  roughFaces_.clear();
  if (face_[from] == kNone) return false;
  const Vec3f start = position_[from];
  const Index face = reference_->locate(face_[from], start, n_);
  if (face == kNone) return false;
  return !isOn(Outcome::Crossing) || edgeNear(face, {start, position_[to] - start, n_, false}, to);
}

bool Part::flipIntersects(const Index* v) {
  unsigned all = 0;
  for (int k = 0; k < 4; ++k) all |= flags_[v[k]];
  if ((all & kNarrow) == 0 || !isOn(Outcome::Intersection)) return false;
  const Index vertices[2][3] = {{v[0], v[1], v[3]}, {v[3], v[2], v[0]}};
  NewTriangles made;
  made.count = 2;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 3; ++j) {
      made.vertices[i][j] = vertices[i][j];
      made.corners[i][j] = position_[vertices[i][j]];
    }
  }
  return intersects(made, false);
}

// As sideGuard().
bool Part::flipKeepsSide(const Index* v) const {
  std::array<Index, kSmallComponent> room;
  const std::span<const Index> component = smallComponent(flip_[0] / 3, room);
  if (component.empty()) return true;
  const Vec3f from = position_[v[0]];
  const auto seen = [&](Index vertex) { return position_[vertex] - from; };
  ComponentSize before, after;
  for (const Index t : component) {
    Vec3f p[3];
    triangleAt(t, p);
    before.add(p[0] - from, p[1] - from, p[2] - from);
    if (t == flip_[0] / 3 || t == flip_[1] / 3) continue;
    after.add(p[0] - from, p[1] - from, p[2] - from);
  }
  after.add(seen(v[0]), seen(v[1]), seen(v[3])), after.add(seen(v[3]), seen(v[2]), seen(v[0]));
  return keepsInside(before, after);
}

// As passesOver(): whether a component lies between the old triangles and the new ones.
bool Part::flipPassesOver(const Index* v) {
  Box3f whole;
  unsigned all = 0;
  for (int k = 0; k < 4; ++k) {
    whole.add(position_[v[k]]);
    all |= flags_[v[k]];
  }
  if ((all & kNarrow) == 0) return false;
  return hasComponentIn(whole, [&](Vec3f p) {
    Vec3f a[4];
    for (int k = 0; k < 4; ++k) a[k] = position_[v[k]] - p;
    return solidAngle(a[0], a[1], a[3]) + solidAngle(a[3], a[2], a[0]) -
           solidAngle(a[0], a[1], a[2]) - solidAngle(a[3], a[2], a[1]);
  });
}

// The first triangle becomes (v0, v1, v3) at corner c and the next ones, the second (v3, v2, v0) at
// d and the next ones.
void Part::applyFlip(const Index* v) {
  const Index c = flip_[0], d = flip_[1];
  const Index nextC = nextCorner(c), nextD = nextCorner(d);
  const Index across02 = opposite_[nextC], across31 = opposite_[nextD];
  vertex_[previousCorner(c)] = v[3];
  vertex_[previousCorner(d)] = v[0];
  const auto stitch = [&](Index p, Index q) {
    opposite_[p] = q;
    if (q != kNone) opposite_[q] = p;
  };
  stitch(c, across31);
  stitch(d, across02);
  stitch(nextC, nextD);
  corner_[v[0]] = c, corner_[v[3]] = d, corner_[v[1]] = nextC, corner_[v[2]] = nextD;
  emptySamples(c / 3);
  emptySamples(d / 3);
  giveSamples();
  for (int i = 0; i < newAxes_; ++i) axis_[newAxis_[i].vertex] = newAxis_[i].axis;
  for (int k = 0; k < 4; ++k) ++version_[v[k]];
  // A triangle in a narrow place keeps a marked corner.
  const unsigned narrow = (flags_[v[1]] | flags_[v[2]]) & kNarrow;
  for (const Index i : {v[0], v[3]}) flags_[i] = static_cast<std::uint8_t>(flags_[i] | narrow);
  if (hasBoxList_) renewBox(c / 3), renewBox(d / 3);
}

}  // namespace tufa::reduce
