// Guards against folds, crossings within stars, and slivers.

#include <algorithm>
#include <cmath>

#include "reduce/component_size.h"
#include "reduce/part.h"

namespace tufa::reduce {
namespace {

constexpr float kNoNormal = 0.001f;    // of 1.8 degrees: the normal of such a sliver says little
constexpr float kFoldFace2 = 0.01f;    // of faces of 0.05 square voxels, whose folds show
constexpr float kLeastLength = 1e-4f;  // of a cross product, in squared voxels: no area at all
constexpr float kNeedleWidth = 0.01f;  // voxels: less is no face of its own between two others
constexpr int kMostBetween = 3;        // so many of them
constexpr float kFold = -0.8655f;      // 149.9 degrees: places are still to be rounded
constexpr float kSameFace = 0.9f;      // of normals, for faces on one side of a wedge

}  // namespace

// The normals of the triangles between spokes to a ring, one behind the other. One without area has
// that of the triangle before it. Whether any has area.
bool Part::normalsOf(const Vec3f* spokes, int count, Vec3f* normals) {
  int last = -1;  // with area
  for (int i = 0; i < count; ++i) {
    const Vec3f c = cross(spokes[i], spokes[i + 1 == count ? 0 : i + 1]);
    const float l = length(c);
    if (l > kLeastLength) {
      normals[i] = c * (1 / l);
      last = i;
    } else {
      normals[i] = last < 0 ? Vec3f() : normals[last];
    }
  }
  if (last < 0) return false;
  for (int i = 0; squaredLength(normals[i]) == 0; ++i) normals[i] = normals[last];
  return true;
}

// The new star, as seen from the place: spokes, normals, axis and frame. Whether any triangle has
// area.
bool Part::makeStar() {
  for (int i = 0; i < size_; ++i) spoke_[i] = position_[ring_[i]] - place_;
  spoke_[size_] = spoke_[0];
  if (!normalsOf(spoke_, size_, normal_)) return false;
  float leastCosine;
  n_ = commonAxis(normal_, size_, leastCosine);
  isGraph_ = leastCosine >= kLeastCosine;
  frame_ = base::frameAbout(n_);
  for (int i = 0; i < size_; ++i) {
    z_[i] = {dot(spoke_[i], frame_.x), dot(spoke_[i], frame_.y), dot(spoke_[i], n_)};
  }
  z_[size_] = z_[0];
  if (isGraph_) return true;
  nearestWedge_ = 0;
  for (int i = 0; i < size_; ++i) {
    constexpr float kRounding = 1e-6f;
    const float area = length(cross(spoke_[i], spoke_[i + 1]));
    const float most = kRounding * length(spoke_[i]) * length(spoke_[i + 1]);
    tilt_[i] = area > kLeastLength ? most / area : 2;
  }
  return true;
}

Outcome Part::shapeGuard(Index a, Index b) {
  if (!makeStar()) return Outcome::Flat;
  const Index ends[2] = {a, b};
  if (!(isGraph_ ? windsInFrame() : isSimpleStar(ends)) && isOn(Outcome::Flat)) {
    return Outcome::Flat;
  }
  return trianglesGuard(position_[a], position_[b]);
}

// Whether the star goes around its axis once. Sets the slopes of its triangles.
bool Part::windsInFrame() {
  int turns = 0;
  for (int i = 0; i < size_; ++i) {
    const Vec3f m{dot(normal_[i], frame_.x), dot(normal_[i], frame_.y), dot(normal_[i], n_)};
    slope_[i] = m * (1 / m.z);
    turns += z_[i].y < 0 && z_[i + 1].y >= 0;
  }
  return turns == 1;
}

// A star without an axis: only where intersections are tested explicitly.
bool Part::isSimpleStar(std::span<const Index> merged) const {
  const auto isNarrow = [&](Index v) { return (flags_[v] & kNarrow) != 0; };
  if (std::none_of(merged.begin(), merged.end(), isNarrow)) return false;
  Vec3f directions[kMostRing];
  for (int i = 0; i < size_; ++i) directions[i] = unit(spoke_[i]);
  return linkIsSimple(directions, size_, 0, size_ - 1);
}

// Compares the triangles with those before. None may turn far, unless it was a sliver or folded
// over. Slivers may be made in the place of as many if the smallest angle of the star does not
// shrink, or as long as they are few in the part, and fewer still where part and star bend both
// ways, so that they follow nothing; and in the place of more if it shrinks little: along a crease
// on which vertices crowd, needles get longer until the last of them goes.
Outcome Part::trianglesGuard(Vec3f a, Vec3f b) {
  const float limit = limits_.leastSine2;
  float after = 1, before = 1;
  newSlivers_ = 0;
  // One that was folded over may turn: the ring, and so the sum of the star's areas, is the same.
  const auto wasFolded = [&](Vec3f was, float area2) {
    const float along = dot(was, n_);
    return along < 0 || along * along < kLeastCosine * kLeastCosine * area2;
  };
  for (int i = 0; i < size_; ++i) {
    const Vec3f old = (i < split_ ? a : b) - place_, x = spoke_[i], y = spoke_[i + 1];
    const Vec3f was = cross(x - old, y - old);
    const float area2Was = squaredLength(was), turn = dot(normal_[i], was);
    const float then =
        leastSine2(area2Was, squaredLength(x - old), squaredLength(y - old), squaredLength(y - x));
    const bool keeps =
        turn > 0 && turn * turn >= limits_.turnCosine * limits_.turnCosine * area2Was;
    if (!keeps && then > kNoNormal && area2Was > kTinyFace2 &&
        !(isGraph_ && wasFolded(was, area2Was)) && isOn(Outcome::Turn)) {
      return Outcome::Turn;
    }
    const float now = leastSine2(squaredLength(cross(x, y)), squaredLength(x), squaredLength(y),
                                 squaredLength(y - x));
    before = std::min(before, then), after = std::min(after, now);
    newSlivers_ += (now < limit) - (then < limit);
  }
  for (const Vec3f x : {spoke_[0] + place_, spoke_[split_] + place_}) {  // those that vanish
    const Vec3f u = a - x, v = b - x;
    const float then = leastSine2(squaredLength(cross(u, v)), squaredLength(u), squaredLength(v),
                                  squaredLength(a - b));
    before = std::min(before, then);
    newSlivers_ -= then < limit;
  }
  if (after >= limit || !isOn(Outcome::Round)) return Outcome::Done;
  if (after >= before && newSlivers_ <= 0) return Outcome::Done;
  if (newSlivers_ < 0 && after >= std::min(kWorstSine2, kSharper2 * before)) return Outcome::Done;
  const auto isWithin = [&](float share) {
    return static_cast<float>(sliverCount_ + newSlivers_) <= share * static_cast<float>(alive_);
  };
  const bool isFew = isWithin(limits_.bentSliverShare) ||
                     (isWithin(limits_.sliverShare) && !(isBent_ && isStarBent()));
  return isFew && after >= kWorstSine2 ? Outcome::Done : Outcome::Round;
}

// Whether the surface bends both ways at most of the samples below the star, of which the first few
// of each triangle are asked.
bool Part::isStarBent() const {
  constexpr int kMostAsked = 16;
  int bent = 0;  // less those that are not
  for (int i = 0; i < size_; ++i) {
    Index s = firstSample_[at_[i] / 3];
    for (int asked = 0; s != kNone && asked < kMostAsked; ++asked, s = samples_[s].next) {
      bent += reference_->isBent(sampleIds_[s]) ? 1 : -1;
    }
  }
  return bent > 0;
}

// Of the triangle across the edge opposite a corner; not of length 1; 0 if it is not in the part.
Vec3f Part::outerNormal(Index c) const {
  const Index d = opposite_[c];
  if (d == kNone) return {};
  const Vec3f p = position_[vertex_[d]];
  return cross(position_[vertex_[nextCorner(d)]] - p, position_[vertex_[previousCorner(d)]] - p);
}

// Visits turns at edges of the new star, spokes and those of the ring. Faces without area to speak
// of, as between vertices that stand close together on a crease, make no fold that shows; what
// would cross is the business of the star guards.
template <class Visit>
void Part::forTurnsAfter(Visit&& visit) const {
  constexpr float kFoldCosine2 = 0.6f;  // less than the square, so that the root is seldom taken
  const auto isTiny = [&](int i) {
    return squaredLength(cross(spoke_[i], spoke_[i + 1])) <= kTinyFace2;
  };
  for (int i = 0; i < size_; ++i) {
    if (isTiny(i)) continue;
    const int last = i == 0 ? size_ - 1 : i - 1;
    if (!isTiny(last)) {
      visit(Turn{normal_[i], normal_[last], dot(normal_[i], normal_[last]),
                 dot(normal_[i], spoke_[last])});
    }
    const Vec3f outer = outerNormal(at_[i]);
    const float cosine = dot(normal_[i], outer), outer2 = squaredLength(outer);
    if (cosine < 0 && outer2 > kTinyFace2 && cosine * cosine > kFoldCosine2 * outer2) {
      const Vec3f apex = position_[vertex_[opposite_[at_[i]]]] - place_;
      visit(Turn{normal_[i], outer, cosine / length(outer), dot(normal_[i], apex - spoke_[i])});
    }
  }
}

Part::Sharpest Part::sharpestAfter() const {
  Sharpest sharpest;
  forTurnsAfter([&](const Turn& turn) { sharpest.see(turn); });
  return sharpest;
}

// A sharper turn than kFoldCosine passes only where the old star had one as sharp to the same side,
// which it has on a wedge of the solid, be it with needles between its sides, and one that counts
// as a fold only where the old star had that fold without any between. Small faces do not count
// there: a fold of theirs must not grow.
bool Part::foldGuard(std::span<const Index> merged) const {
  constexpr float kSlack = 0.01f;
  const Sharpest after = sharpestAfter();
  if (after.least() >= kFoldCosine) return true;
  if (after.least() < kSharpestCosine) return false;
  if (after.least() < kFold && !foldsWereThere(merged)) return false;
  const Sharpest before = sharpestBefore(merged, kMostBetween);
  return (after.ridge >= kFoldCosine || after.ridge >= before.ridge - kSlack) &&
         (after.valley >= kFoldCosine || after.valley >= before.valley - kSlack);
}

// Whether for each fold of the new star the old one had a fold to the same side, between faces that
// faced the same ways: a wedge makes no other edge beside it a wedge.
bool Part::foldsWereThere(std::span<const Index> merged) const {
  bool all = true;
  forTurnsAfter([&](const Turn& now) {
    if (now.cosine >= kFold || !all) return;
    const Vec3f next = unit(now.next);
    bool was = false;
    forTurnsBefore(merged, 0, [&](const Turn& then) {
      if (then.cosine >= kFold || (then.height > 0) != (now.height > 0)) return;
      const Vec3f nextThen = unit(then.next);
      was |= (dot(now.normal, then.normal) > kSameFace && dot(next, nextThen) > kSameFace) ||
             (dot(now.normal, nextThen) > kSameFace && dot(next, then.normal) > kSameFace);
    });
    all &= was;
  });
  return all;
}

// Visits the turns from a face to the one across an edge of it, or to those beyond the needles
// without width next to it, as they lie along creases: `between` of them at most. `p` is a vertex
// of the face.
template <class Visit>
void Part::forTurnsAcross(Vec3f normal, Vec3f p, Index edge, int between, Visit& visit) const {
  const Index d = opposite_[edge];
  if (d == kNone) return;
  const Vec3f outer = outerNormal(edge);
  const float outer2 = squaredLength(outer);
  if (outer2 > kFoldFace2) {
    visit(Turn{normal, outer, dot(normal, unit(outer)), dot(normal, position_[vertex_[d]] - p)});
    return;
  }
  if (between == 0 || outer2 > kNeedleWidth * kNeedleWidth * longestEdge2(d / 3)) return;
  forTurnsAcross(normal, p, nextCorner(d), between - 1, visit);
  forTurnsAcross(normal, p, previousCorner(d), between - 1, visit);
}

float Part::longestEdge2(Index t) const {
  Vec3f p[3];
  triangleAt(t, p);
  return std::max(
      {squaredLength(p[1] - p[0]), squaredLength(p[2] - p[1]), squaredLength(p[0] - p[2])});
}

// The same for all edges of the stars that are merged.
template <class Visit>
void Part::forTurnsBefore(std::span<const Index> merged, int between, Visit&& visit) const {
  for (const Index v : merged) {
    Index c = corner_[v];
    do {
      const Index t = 3 * (c / 3);
      const Vec3f p = position_[vertex_[t]];
      const Vec3f own = cross(position_[vertex_[t + 1]] - p, position_[vertex_[t + 2]] - p);
      if (squaredLength(own) > kFoldFace2) {
        for (const Index edge : {c, nextCorner(c)}) {
          forTurnsAcross(unit(own), p, edge, between, visit);
        }
      }
      c = around(c);
    } while (c != corner_[v]);
  }
}

Part::Sharpest Part::sharpestBefore(std::span<const Index> merged, int between) const {
  Sharpest sharpest;
  forTurnsBefore(merged, between, [&](const Turn& turn) { sharpest.see(turn); });
  return sharpest;
}

// The stars of the ring, where the new triangles do not face the axes that they have.
bool Part::ringGuard() {
  newAxes_ = 0;
  for (int i = 0; i < size_; ++i) {
    const Index v = ring_[i];
    const Vec3f axis = axis_[v];
    if (dot(axis, normal_[i]) >= kLeastCosine &&
        dot(axis, normal_[i == 0 ? size_ - 1 : i - 1]) >= kLeastCosine) {
      continue;
    }
    if (inner_[v] == 0) return false;
    if (!starGuard(v, linkAfterMerging(v))) return false;
  }
  return true;
}

// Once all merged vertices are one at the place.
Part::Link Part::linkAfterMerging(Index v) const {
  Link link;
  Index c = corner_[v];
  do {
    const Index x = vertex_[nextCorner(c)], y = vertex_[previousCorner(c)];
    const bool isNew = isMerged(x);
    if (!isNew || !isMerged(y)) {
      if (isNew) link.changed = link.count;
      link.add((isNew ? place_ : position_[x]) - position_[v]);
    }
    c = around(c);
  } while (c != corner_[v] && link.count < kMostRing);
  if (c != corner_[v]) link.count = 0;
  return link;
}

// The whole star of a vertex as it would be: there is an axis for it, which is noted, or its link
// is simple, where intersections are tested explicitly.
bool Part::starGuard(Index v, const Link& link) {
  if (link.count < 3 || newAxes_ >= kMostRing) return false;
  Vec3f normals[kMostRing + 1];
  if (!normalsOf(link.to, link.count, normals)) return false;
  float leastCosine;
  Vec3f axis = commonAxis(normals, link.count, leastCosine);
  if (leastCosine < kLeastCosine || !windsOnce(link.to, link.count, axis)) {
    if ((flags_[v] & kNarrow) == 0) return false;
    Vec3f directions[kMostRing + 1];
    for (int i = 0; i < link.count; ++i) directions[i] = unit(link.to[i]);
    // A star without an axis was simple before, so that only what is new may cross.
    const int first = hasAxis(v) ? 0 : link.changed;
    const int last = hasAxis(v) ? link.count - 1 : link.changed;
    if (!linkIsSimple(directions, link.count, first, last)) return false;
    axis = {};
  }
  newAxis_[newAxes_++] = {v, axis};
  return true;
}

// The component of a triangle, if it has no more triangles than there is room for, and no border.
std::span<const Index> Part::smallComponent(Index triangle, std::span<Index> room) const {
  room[0] = triangle;
  std::size_t count = 1;
  for (std::size_t k = 0; k < count; ++k) {
    for (Index i = 0; i < 3; ++i) {
      const Index d = opposite_[3 * room[k] + i];
      if (d == kNone) return {};
      const auto end = room.begin() + static_cast<std::ptrdiff_t>(count);
      if (std::find(room.begin(), end, d / 3) != end) continue;
      if (count == room.size()) return {};
      room[count++] = d / 3;
    }
  }
  return room.first(count);
}

// Small components keep their inside, and a thickness. Larger ones cannot be turned inside out
// without an intersection on the way; in one of few triangles all may share a vertex with the star,
// so that there is no pair to test.
bool Part::sideGuard() const {
  if (size_ > kSmallComponent / 2) return true;
  std::array<Index, kSmallComponent> room;
  const std::span<const Index> component = smallComponent(at_[0] / 3, room);
  if (component.empty()) return true;
  ComponentSize before, after;
  for (const Index t : component) {
    Vec3f p[3], q[3];
    for (Index i = 0; i < 3; ++i) {
      const Index v = vertex_[3 * t + i];
      p[i] = position_[v] - place_;
      q[i] = isMerged(v) ? Vec3f() : p[i];
    }
    before.add(p[0], p[1], p[2]), after.add(q[0], q[1], q[2]);
  }
  return keepsInside(before, after);
}

}  // namespace tufa::reduce
