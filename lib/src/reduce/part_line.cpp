// Collapses at lines, the edges between regions: which vertex stays, and what a region may not do.
//
// In LineMode::Alone vertices go, or two neighbours on a line become one at a new place in its
// plane. So what each vertex went into, and where that is now, is all that is needed to give a
// region the lines of the coarser mesh: see chunks/chain/chunk_chain.h.

#include <algorithm>
#include <limits>

#include "reduce/part.h"

namespace tufa::reduce {
void Part::loadLines(const Surface& surface) {
  hasLines_ = surface.hasLines();
  if (!hasLines_) return;
  const auto vertices = partition_->vertices(number_);
  line_.resize(vertexCount_), region_.resize(triangleCount_);
  for (Index i = 0; i < vertexCount_; ++i) {
    const Index v = vertices[i];
    LineVertex& line = line_[i];
    line = {surface.lineStep.empty() ? LineStep() : surface.lineStep[v], surface.lineKind[v]};
    if (line.kind != LineKind::Off) line.planes = surface.planesOf(surface.sourceOf(v));
  }
  for (Index t = 0; t < triangleCount_; ++t) region_[t] = surface.region[triangleIds_[t]];
  wentInto_.clear();
  if (isAlone()) loadForms(surface);
}

void Part::storeLines(Surface& surface) const {
  if (!hasLines_ || !isAlone()) return;
  for (const auto& [from, to, plane] : wentInto_) {
    surface.into[from] = to, surface.intoPlane[from] = plane;
  }
  for (const auto& [region, forms] : formsOf_) {
    for (const Index t : forms.changed) surface.changeOf[triangleIds_[t]] = changeOf_[t];
  }
}

// Whether the edge opposite a corner is between two regions.
bool Part::isLineEdge(Index c) const {
  return opposite_[c] != kNone && region_[c / 3] != region_[opposite_[c] / 3];
}

// Those of two neighbours, at least one of them on a line, that may stay; kNone for none.
std::array<Index, 2> Part::keptAtLine(Index a, Index b) const {
  const LineKind p = line_[a].kind, q = line_[b].kind;
  if (limits_.lines == LineMode::Alone) {
    return {mayGoAlone(b, a) ? a : kNone, mayGoAlone(a, b) ? b : kNone};
  }
  if (p == LineKind::Off || q == LineKind::Off) return {q == LineKind::Off ? a : b, kNone};
  if (limits_.lines == LineMode::Held) return {kNone, kNone};
  return {q == LineKind::On ? a : kNone, p == LineKind::On ? b : kNone};
}

// The plane of the line beside a vertex off it; kNone if there is none, or are several.
Index Part::planeBeside(Index v) const {
  Index plane = kNone, c = corner_[v];
  do {
    const LineVertex& other = line_[vertex_[nextCorner(c)]];
    if (other.kind == LineKind::On && plane != kNone && other.planes[0] != plane) return kNone;
    if (other.kind == LineKind::On) plane = other.planes[0];
    c = around(c);
  } while (c != corner_[v]);
  return plane;
}

// Triangles may not change in a second plane: then each has two forms, and what holds for all
// triangles in the one and in the other form holds for any mixture.
bool Part::mayGoAlone(Index gone, Index kept) const {
  const LineVertex &from = line_[gone], &to = line_[kept];
  if (from.kind == LineKind::End) return false;
  if (from.kind == LineKind::On) {
    return to.kind != LineKind::Off && from.mayChange(from.planes[0]);
  }
  if (!from.isBeside) return false;
  const Index plane = planeBeside(gone);
  if (plane == kNone || !from.mayChange(plane)) return false;
  return to.kind == LineKind::End || (to.kind == LineKind::On && to.planes[0] == plane) ||
         (to.kind == LineKind::Off && to.mayChange(plane));
}

// The quadric error at the better one of the places that a collapse may have.
float Part::errorAtLine(Index a, Index b, Vec3f place, const LocalQuadric& sum) const {
  float least = std::numeric_limits<float>::infinity();
  const Index moving = movingAtLine(a, b);
  if (moving != kNone) {
    least = std::max(0.0f, sum.at(bestInPlane(moving, moving == a ? b : a, place, sum) - place));
  }
  for (const Index kept : keptAtLine(a, b)) {
    if (kept != kNone) least = std::min(least, std::max(0.0f, sum.at(position_[kept] - place)));
  }
  return least;
}

Outcome Part::tryCollapseAtLine(Index a, Index b) {
  std::array<Index, 2> kept = keptAtLine(a, b);
  Vec3f exact;
  solve(a, b, exact, sum_);
  const auto errorAt = [&](Index v) { return sum_.at(position_[v] - exact); };
  if (kept[0] != kNone && kept[1] != kNone && errorAt(kept[1]) < errorAt(kept[0])) {
    std::swap(kept[0], kept[1]);
  }
  const float most = limits_.errorShare * limits_.distance;
  Outcome outcome = Outcome::Place;
  const auto isCheap = [&](Vec3f place) {
    return sum_.at(place - exact) <= most * most * sum_.weight;
  };
  struct Choice {
    Index kept;
    Vec3f place;
  };
  Choice choices[3] = {{kNone, {}}, {kept[0], {}}, {kept[1], {}}};
  if (const Index moving = movingAtLine(a, b); moving != kNone) {
    const Index other = moving == a ? b : a;
    choices[0] = {moving, bestInPlane(moving, other, exact, sum_)};
  }
  for (int i : {1, 2}) {
    if (choices[i].kept != kNone) choices[i].place = position_[choices[i].kept];
  }
  for (const auto& [k, place] : choices) {
    if (k == kNone || !isCheap(place)) continue;
    const Index gone = k == a ? b : a;
    outcome = tryInto(k, gone, place);
    if (outcome != Outcome::Done) continue;
    sum_.moveBy(place_ - exact);
    if (isAlone()) noteGone(k, gone);
    apply(k, gone);
    for (int i = 0; i < size_; ++i) propose(k, ring_[i]);
    return outcome;
  }
  return outcome;
}

// Which of two neighbours, at least one of them on a line, stays on its line if they become one at
// a new place in its plane: where the rest is reduced too, the other one is on that line or on
// none; where lines alone are, both are on it, and what changes around both changes for their plane
// only. Else kNone.
Index Part::movingAtLine(Index a, Index b) const {
  if (limits_.lines == LineMode::Held || surface_->planeNormals.empty()) return kNone;
  const Index on = line_[a].kind == LineKind::On ? a : b, other = on == a ? b : a;
  const LineVertex &p = line_[on], &q = line_[other];
  if (p.kind != LineKind::On || p.planes[0] == kNone || q.kind == LineKind::End) return kNone;
  if (limits_.lines == LineMode::Alone) {
    const bool mayMove = q.kind == LineKind::On && p.mayChange(p.planes[0]);
    if (!mayMove || !mayGoAlone(other, on)) return kNone;
  }
  return q.kind == LineKind::Off || q.planes[0] == p.planes[0] ? on : kNone;
}

// The place of least error in the plane of the vertex that stays, which is not farther from where
// it was, or from the middle of the two if both are on the line, than they were from each other.
// `sum` is seen from `place`.
Vec3f Part::bestInPlane(Index kept, Index gone, Vec3f place, const LocalQuadric& sum) const {
  const base::Frame frame = base::frameAbout(surface_->planeNormals[line_[kept].planes[0]]);
  const Vec3f from = isOnLine(gone) ? (position_[kept] + position_[gone]) * 0.5f : position_[kept];
  LocalQuadric q = sum;
  q.moveBy(from - place);
  const Vec3f off = q.minimumAlong(frame.x, frame.y);
  return squaredLength(off) <= squaredLength(position_[kept] - position_[gone]) ? from + off : from;
}

Outcome Part::tryInto(Index kept, Index gone, Vec3f place) {
  if (!gatherRing(kept, gone)) return Outcome::Link;
  if (isOnLine(kept) && isOnLine(gone)) {
    if (region_[left_ / 3] == region_[right_ / 3]) return Outcome::Link;
    // Where both other edges of a triangle that vanishes are of lines, it is the last of its
    // region.
    const auto isLast = [&](Index c) { return isLineEdge(c) && isLineEdge(nextCorner(c)); };
    if (isLast(left_) || isLast(previousCorner(right_))) return Outcome::Link;
  }
  if (makesChord()) return Outcome::Link;
  const Outcome outcome = tryPlace(kept, gone, place);
  const bool isMixed =
      outcome == Outcome::Done && isAlone() && isOn(Outcome::Intersection) && formsMeet(kept, gone);
  return isMixed ? Outcome::Intersection : outcome;
}

// Whether an edge other than of a line would run from the vertex that stays to another one of a
// line in the same plane, or one of a line where two planes meet or where such a chord was before.
bool Part::makesChord() const {
  const auto sourceOf = [&](Index v) {
    return surface_->sourceOf(partition_->vertices(number_)[v]);
  };
  // In a triangle that vanishes, a chord would become an edge of a line.
  for (const int i : {0, split_}) {
    if (isOnLine(ring_[i]) && surface_->isChord(sourceOf(kept_), sourceOf(ring_[i]))) return true;
  }
  for (int i = split_ + 1; i < size_; ++i) {
    if (!isOnLine(ring_[i])) continue;
    const int common = commonPlanes(line_[kept_].planes, line_[ring_[i]].planes);
    if (common == 0) continue;
    if (region_[at_[i] / 3] == region_[at_[i - 1] / 3]) return true;
    if (common > 1 || surface_->isChord(sourceOf(kept_), sourceOf(ring_[i]))) {
      return true;
    }
  }
  return false;
}

// Notes where a vertex goes, and that the triangles around it change. Called while the ring is that
// of the collapse.
void Part::noteGone(Index kept, Index gone) {
  const Index plane = planeOfGoing(gone);
  wentInto_.push_back({line_[gone].name, line_[kept].name, plane});
  const bool isMoving = isMovingKept();
  if (isMoving) wentInto_.push_back({line_[kept].name, line_[kept].name, plane});
  noteForms(plane);
  const auto note = [&](Index v) {
    line_[v].addChange(plane);
    changes_.push_back({partition_->vertices(number_)[v], plane});
  };
  note(kept);
  for (int i = 0; i < size_; ++i) {
    // Others are beside the one that stays alone.
    if (isMoving || i == 0 || i >= split_) note(ring_[i]);
  }
}

// Vertices stay inside their region; those of lines in their plane, where the regions on both sides
// have the same bounds but for it.
bool Part::mayHold(Index a, Index b) const {
  if (!surface_->mayHold || place_ == position_[a]) return true;
  const Index plane = isOnLine(a) ? line_[a].planes[0] : kNone;
  return surface_->mayHold(region_[left_ / 3], plane, place_, position_[a], position_[b]);
}

bool Part::mayFlipAtLine(const Index* v) const {
  return !isOnLine(v[0]) || !isOnLine(v[3]) ||
         commonPlanes(line_[v[0]].planes, line_[v[3]].planes) == 0;
}

}  // namespace tufa::reduce
