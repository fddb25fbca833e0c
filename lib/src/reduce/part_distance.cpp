// The distance guard: why it bounds the distance between the surfaces, not only at samples.
//
// Overlay the mesh and the reference: every reference vertex has an owner, every vertex lies over a
// face, every edge crosses a sequence of edges of the reference. The pieces of the overlay are
// convex polygons in a triangle and in a face at once. Map one to the other corner by corner: if no
// corner moves farther than the limit, no point of the piece does, as the distance is convex. So
// the limit bounds both ways once it holds at reference vertices, at vertices, and for each pair of
// crossing edges at one point of each, any: at the nearest points. An operation changes the overlay
// within its star only, and exactly these three kinds of points are tested there. Where the
// reference is rough, what is seen along one axis may not be all of it: there faces are tested as
// the certificate does. Around what is smaller than the tolerance a section of the reference may
// lead elsewhere than the edge: then all faces around are tested so.
//
// Vertices that were too far before go first, then the edges, which are fewer than the vertices
// below a large star, then all vertices. Cost: 10 to 20 ns a reference vertex and 10 to 60 ns a
// crossing, most of it waiting for memory.

#include <algorithm>
#include <cmath>

#include "base/huge_pages.h"
#include "base/sort_unique.h"
#include "reduce/overlay_path.h"
#include "reduce/part.h"

namespace tufa::reduce {

Outcome Part::distanceGuard(Index a, Index b) {
  clearTaken();
  if (reference_->isScaled() && !scaleStarTolerance(a)) return Outcome::Sample;
  if (!farSamplesNear()) return Outcome::Sample;
  if (!apexNear(a, b)) return Outcome::Apex;
  asksWays_ = isOn(Outcome::Crossing) && !crossingsNear();
  if (asksWays_ && !limits_.asksFaces) return Outcome::Crossing;
  bool isNear = true;
  for (int i = 0; i < size_ && isNear; ++i) isNear = samplesNear(at_[i] / 3, i);
  if (!isNear || !samplesNear(left_ / 3, 0) || !samplesNear(right_ / 3, split_)) {
    return Outcome::Sample;
  }
  if (asksWays_) return allFacesNear() ? Outcome::Done : Outcome::Crossing;
  if (isOn(Outcome::Face) && !facesNear()) return Outcome::Face;
  return Outcome::Done;
}

// Before another operation is tried.
void Part::clearTaken() {
  taken_.clear();
  roughFaces_.clear();
  asksWays_ = false;
}

// Sets the tolerance of the attempt to the least one at the samples of some triangles and at the
// reference below a vertex of them. Whether there is any left.
bool Part::scaleTolerance(std::span<const Index> triangles, Index vertex) {
  if (face_[vertex] == kNone) return false;
  const auto& below = reference_->vertices(face_[vertex]);
  float scale = reference_->scaleAt(below[0]);
  for (const Index r : below) scale = std::min(scale, reference_->scaleAt(r));
  for (const Index t : triangles) {
    for (Index s = firstSample_[t]; s != kNone; s = samples_[s].next) {
      scale = std::min(scale, reference_->scaleAt(sampleIds_[s]));
    }
  }
  setDistance(limits_.distance * scale);
  return scale > 0;
}

// The same for the triangles that a collapse changes.
bool Part::scaleStarTolerance(Index a) {
  std::array<Index, kMostRing + 2> triangles;
  for (int i = 0; i < size_; ++i) triangles[static_cast<std::size_t>(i)] = at_[i] / 3;
  const auto count = static_cast<std::size_t>(size_);
  triangles[count] = left_ / 3;
  triangles[count + 1] = right_ / 3;
  return scaleTolerance({triangles.data(), count + 2}, a);
}

// The samples that were too far in attempts before: they are likely to be so again.
bool Part::farSamplesNear() {
  if (!isOn(Outcome::Sample)) return true;
  const auto isNear = [&](Index t, int wedge) {
    if (wasFar_[t] == 0) return true;
    const Index s = firstSample_[t];
    const Vec3f p = samples_[s].p - place_;
    return isGraph_ ? sampleNearGraph(s, inFrame(p), wedge) : sampleNearStar(s, p);
  };
  bool areNear = isNear(left_ / 3, 0) && isNear(right_ / 3, split_);
  for (int i = 0; i < size_ && areNear; ++i) areNear = isNear(at_[i] / 3, i);
  taken_.clear();
  return areNear;
}

// All samples of a triangle that changes; notes the new triangles that take them. `wedge`: the new
// triangle that takes most of them.
bool Part::samplesNear(Index t, int wedge) {
  if (isGraph_) return samplesNearGraph(t, wedge);
  Index before = kNone;
  for (Index s = firstSample_[t]; s != kNone; before = s, s = samples_[s].next) {
    if (sampleNearStar(s, samples_[s].p - place_) || !isOn(Outcome::Sample)) continue;
    putFirst(t, before, s);
    return false;
  }
  return true;
}

// The same where the new star is a graph. Several at a time are compared with the one triangle;
// most need no more.
bool Part::samplesNearGraph(Index t, int wedge) {
  constexpr std::size_t kLanes = 8;
  using Lanes = std::array<float, kLanes>;
  const Vec3f a = z_[wedge], b = z_[wedge + 1], slope = slope_[wedge];
  const Index taker = at_[wedge] / 3;
  Index last = kNone;
  for (Index s = firstSample_[t]; s != kNone;) {
    std::array<Index, kLanes> ids;
    Lanes px, py, pz, x, y, z;
    std::size_t count = 0;
    for (; count < kLanes && s != kNone; ++count, s = samples_[s].next) {
      const Vec3f p = samples_[s].p - place_;
      ids[count] = s, px[count] = p.x, py[count] = p.y, pz[count] = p.z;
    }
    for (std::size_t i = count; i < kLanes; ++i) px[i] = py[i] = pz[i] = 0;
    std::array<std::uint8_t, kLanes> isNear;
    for (std::size_t i = 0; i < kLanes; ++i) {
      x[i] = px[i] * frame_.x.x + py[i] * frame_.x.y + pz[i] * frame_.x.z;
      y[i] = px[i] * frame_.y.x + py[i] * frame_.y.y + pz[i] * frame_.y.z;
      z[i] = px[i] * n_.x + py[i] * n_.y + pz[i] * n_.z;
      const int isLeft = a.x * y[i] - a.y * x[i] >= 0, isRight = b.x * y[i] - b.y * x[i] < 0;
      const int isInside = (b.x - a.x) * (y[i] - a.y) - (b.y - a.y) * (x[i] - a.x) >= 0;
      const float height = x[i] * slope.x + y[i] * slope.y + z[i] * slope.z;
      const int isLow = std::abs(height) <= distance_;
      isNear[i] = static_cast<std::uint8_t>(isLeft & isRight & isInside & isLow);
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (isNear[i] != 0) {
        taken_.push_back({ids[i], taker});
      } else if (!sampleNearGraph(ids[i], {x[i], y[i], z[i]}, wedge) && isOn(Outcome::Sample)) {
        putFirst(t, i == 0 ? last : ids[i - 1], ids[i]);
        return false;
      }
    }
    last = ids[count - 1];
  }
  return true;
}

// A sample that is too far goes first in its triangle's list, as it is likely to be so again.
void Part::putFirst(Index t, Index before, Index s) {
  wasFar_[t] = 1;
  if (before == kNone) return;
  samples_[before].next = samples_[s].next;
  samples_[s].next = firstSample_[t];
  firstSample_[t] = s;
}

// Seen in the frame. By the triangle above or below it: its plane's height first, as that is cheap.
bool Part::sampleNearGraph(Index s, Vec3f q, int wedge) {
  const int w = wedgeOf(q, wedge);
  taken_.push_back({s, at_[w] / 3});
  const bool isOutside =
      (z_[w + 1].x - z_[w].x) * (q.y - z_[w].y) - (z_[w + 1].y - z_[w].y) * (q.x - z_[w].x) < 0;
  if (!isOutside && std::abs(dot(q, slope_[w])) <= distance_) return true;
  return squaredDistanceToTriangle(q, {}, z_[w], z_[w + 1]) <= squaredDistance_;
}

// The star is no graph: by the nearest of all its triangles. The one that was nearest to the sample
// before goes first; then triangles whose planes are farther away can be left out.
bool Part::sampleNearStar(Index s, Vec3f p) {
  constexpr float kSlack = 1e-4f;  // voxels; more than rounding of the distance
  const float far = length(p);
  const auto distance2 = [&](int i) {
    return squaredDistanceToTriangle(p, {}, spoke_[i], spoke_[i + 1]);
  };
  int wedge = nearestWedge_;
  float best = distance2(wedge);
  for (int i = 0; i < size_; ++i) {
    const float away = std::abs(dot(normal_[i], p)) - tilt_[i] * far - kSlack;
    if (i == nearestWedge_ || (away > 0 && away * away > best)) continue;
    const float d2 = distance2(i);
    if (d2 < best || (d2 == best && i < wedge)) best = d2, wedge = i;
  }
  nearestWedge_ = wedge;
  taken_.push_back({s, at_[wedge] / 3});
  return best <= squaredDistance_;
}

// The triangle of the star that is above or below s, in the frame, from `likely` on round the star
// to the side that s is on.
int Part::wedgeOf(Vec3f s, int likely) const {
  const auto side = [&](int i) { return z_[i].x * s.y - z_[i].y * s.x; };
  int i = likely;
  const float atStart = side(i), atEnd = side(i + 1);
  if (atStart >= 0 && atEnd < 0) return i;
  const bool isForward = atStart >= 0;
  for (int left = size_ - 1; left > 0; --left) {
    i = isForward ? (i + 1 == size_ ? 0 : i + 1) : (i == 0 ? size_ : i) - 1;
    if (side(i) >= 0 && side(i + 1) < 0) return i;
  }
  return 0;  // the apex itself
}

// Finds the face of the reference below the apex, from that of the nearer end of the edge.
bool Part::apexNear(Index a, Index b) {
  constexpr int kMostSteps = 256;
  const bool isNearA = squaredLength(position_[a] - place_) <= squaredLength(position_[b] - place_);
  const Index start = isNearA ? face_[a] : face_[b];
  if (start == kNone) return false;
  apexFace_ = reference_->locate(start, place_, n_, kMostSteps);
  if (apexFace_ == kNone) return false;
  return reference_->distance(apexFace_, place_) <= distance_ || !isOn(Outcome::Apex);
}

// All crossings of the spokes with edges of the reference; the sharpest spoke first, as it is the
// likeliest to be too far.
bool Part::crossingsNear() {
  int sharpest = 0;
  float leastCosine = 2;
  for (int i = 0; i < size_; ++i) {
    const float cosine = dot(normal_[i], normal_[i == 0 ? size_ - 1 : i - 1]);
    if (cosine < leastCosine) leastCosine = cosine, sharpest = i;
  }
  for (int k = 0; k < size_; ++k) {
    const int i = sharpest + k < size_ ? sharpest + k : sharpest + k - size_;
    if (!edgeNear(apexFace_, {place_, spoke_[i], n_, !isGraph_}, ring_[i])) return false;
  }
  return true;
}

// Whether an edge stays near the reference, walking from the face below its start. Where the
// reference bends away around a crease just before the end, the section never passes the end: it
// then is enough that it came near it, as all triangles around the end have that in common. The end
// is at the vertex `end`. Where the surface is steep, a section may pass over the end at a
// distance: it is then not the way there.
bool Part::edgeNear(Index face, const ReferenceMesh::Section& section, Index end) {
  constexpr float kFarTolerance = 0.25f;  // voxels; with a larger one a walk may stray anywhere
  constexpr float kArrived = 0.5f;        // voxels from the end, and twice the distance allowed
  const Vec3f z = section.along;
  const float scale = 1 / squaredLength(z);
  const float close2 = std::min(kArrived * kArrived, 4 * squaredDistance_);
  const bool isFlip = flip_[0] != kNone;  // of an edge that is nearly flat
  bool hasArrived = false, isFar = false;
  walkedTo_ = face;
  const auto isNear = [&](Index crossed, Vec3f m, Vec3f right, Vec3f left) {
    walkedTo_ = crossed;
    const bool isLooked = isFlip ? reference_->isHeld(crossed) : reference_->isRoughFace(crossed);
    if (isLooked) roughFaces_.push_back(crossed);
    const float share = std::clamp(dot(m, z) * scale, 0.0f, 1.0f);
    const bool ok = squaredLength(m - z * share) <= squaredDistance_ ||
                    squaredDistanceOfSegments(right, left, {}, z) <= squaredDistance_;
    isFar = !ok;
    hasArrived |= ok && squaredLength(m - z) <= close2;
    return ok;
  };
  const ReferenceMesh::Arrival arrival = reference_->follow(face, section, isNear);
  if (!arrival) {
    if (!hasArrived && (isFar || !limits_.isLoose)) return false;
    if (!limits_.isLoose) noteFacesBetween(walkedTo_, end);
  } else if (!limits_.isLoose && squaredLength(arrival.at - z) > squaredDistance_ &&
             reference_->distance(arrival.face, section.start + z) > distance_) {
    return false;
  }
  const bool mayStray = (flags_[end] & kNarrow) != 0 || limits_.distance > kFarTolerance;
  return !mayStray || limits_.isLoose || isBelow(walkedTo_, end, section.axis);
}

// Where a walk has ended near a vertex but not at it: the faces that it did not pass.
void Part::noteFacesBetween(Index face, Index vertex) {
  for (const Index f : {face, face_[vertex]}) {
    if (f == kNone) continue;
    for (const Index v : reference_->vertices(f)) {
      reference_->allAround(v, [&](Index around) {
        roughFaces_.push_back(around);
        return true;
      });
    }
  }
}

// Whether all faces of the reference at samples that change their owner have ways, those first at
// which the last section was lost: most operations that fail, fail there. Not on a wedge, whose
// edges the fold guard lets be as sharp as they were: with the coarser steps allowed here, some
// would become folds.
bool Part::allFacesNear() {
  constexpr std::size_t kMost = 8192;  // samples; more would take milliseconds
  if (taken_.size() > kMost || sharpestAfter().least() < kFoldCosine) return false;
  const auto ask = [&](Index v) {
    reference_->allAround(v, [&](Index f) {
      roughFaces_.push_back(f);
      return true;
    });
  };
  for (const Index v : reference_->vertices(walkedTo_)) ask(v);
  if (!facesNear()) return false;
  for (const Taken& t : taken_) ask(sampleIds_[t.sample]);
  return facesNear();
}

// Whether a vertex is over the sheet of the reference that a face is on: a way along an edge may
// end on another sheet that is as near. Then the surface between would be over no part of the
// reference. Faces on one sheet have a common vertex.
bool Part::isBelow(Index face, Index vertex, Vec3f axis) const {
  const Index own = face_[vertex];
  if (own == kNone) return false;
  const Index found =
      reference_->locate(face, position_[vertex], hasAxis(vertex) ? axis_[vertex] : axis);
  if (found == kNone) return false;
  const auto& f = reference_->vertices(found);
  const auto& g = reference_->vertices(own);
  return std::any_of(f.begin(), f.end(),
                     [&](Index v) { return v == g[0] || v == g[1] || v == g[2]; });
}

// The mesh as it would be, for overlay_path.h. What collapse and flip change in the tables is few
// enough to be told here corner by corner.
struct Part::Changed {
  const Part& part;

  [[nodiscard]] Index vertex(Index t, int i) const {
    const Index c = 3 * t + static_cast<Index>(i), v = part.vertex_[c];
    if (part.flip_[0] == kNone) return part.isMerged(v) ? part.kept_ : v;
    if (c == previousCorner(part.flip_[0])) return part.vertex_[part.flip_[1]];
    if (c == previousCorner(part.flip_[1])) return part.vertex_[part.flip_[0]];
    return v;
  }
  Vec3f operator()(Index t, int i) const {
    const Index v = vertex(t, i);
    return part.flip_[0] == kNone && v == part.kept_ ? part.place_ : part.position_[v];
  }
  [[nodiscard]] Index across(Index t, int i) const {
    const Index c = 3 * t + static_cast<Index>(i);
    const Index d = part.flip_[0] != kNone ? afterFlip(c)
                    : part.isContraction_  ? afterContraction(c)
                                           : afterCollapse(part.opposite_[c]);
    return d == kNone ? kNone : d / 3;
  }

 private:
  [[nodiscard]] Index afterCollapse(Index c) const {
    if (c == part.left_) return part.opposite_[nextCorner(part.left_)];
    if (c == nextCorner(part.left_)) return part.opposite_[part.left_];
    if (c == part.right_) return part.opposite_[previousCorner(part.right_)];
    if (c == previousCorner(part.right_)) return part.opposite_[part.right_];
    return c;
  }
  // At the ring's triangles, which have one merged vertex each.
  [[nodiscard]] Index afterContraction(Index c) const {
    const Index first = 3 * (c / 3);
    Index corner = first;
    while (corner < first + 3 && !part.isMerged(part.vertex_[corner])) ++corner;
    if (corner == first + 3 || corner == c) return part.opposite_[c];
    const int i = static_cast<int>(std::find(part.at_, part.at_ + part.size_, corner) - part.at_);
    if (c == nextCorner(corner)) return previousCorner(part.at_[i + 1 == part.size_ ? 0 : i + 1]);
    return nextCorner(part.at_[i == 0 ? part.size_ - 1 : i - 1]);
  }
  [[nodiscard]] Index afterFlip(Index c) const {
    for (int k = 0; k < 2; ++k) {
      const Index own = part.flip_[k], other = part.flip_[1 - k];
      if (c == own) return part.opposite_[nextCorner(other)];
      if (c == nextCorner(own)) return nextCorner(other);
      if (part.opposite_[c] == nextCorner(own)) return other;
    }
    return part.opposite_[c];
  }
};

// The triangle that would own a reference vertex, or kNone if it is none of this part. Owners in
// the surface may not be read here: other parts write theirs.
Index Part::ownerAfter(Index r) const {
  const Index local = localSample(r);
  if (local == kNone) return kNone;
  const Taker& taker = takers_[local];
  return taker.stamp == now_ ? taker.triangle : owners_[local];
}

// The number of a reference vertex in this part, or kNone.
Index Part::localSample(Index r) const {
  const Index local = surface_->isWhole ? partition_->localVertex(r) : partition_->localSample(r);
  return local < sampleIds_.size() && sampleIds_[local] == r ? local : kNone;
}

// Whether nothing less than ways is a bound at a face.
bool Part::requiresWays(Index face) const {
  const auto v = reference_->vertices(face);
  return std::any_of(v.begin(), v.end(), [&](Index r) {
    const Index local = localSample(r);
    return reference_->requiresWays(r) || (local != kNone && isRough_[local] == kWays);
  });
}

// Faces of the reference at rough vertices that change their owner, and held ones below an edge
// that changes.
bool Part::facesNear() {
  for (const Taken& t : taken_) {
    if (!hasRough_) break;
    if (isRough_[t.sample] == 0) continue;
    reference_->allAround(sampleIds_[t.sample], [&](Index f) {
      roughFaces_.push_back(f);
      return true;
    });
  }
  if (roughFaces_.empty()) return true;
  base::sortUnique(roughFaces_);
  if (takers_.empty()) {
    base::reserveLarge(takers_, owners_.size());
    takers_.resize(owners_.size(), {kNone, 0});
  }
  for (const Taken& t : taken_) {
    takers_[t.sample] = {t.triangle, now_};
  }
  return std::all_of(roughFaces_.begin(), roughFaces_.end(), [&](Index f) { return faceNear(f); });
}

bool Part::faceNear(Index face) const {
  const Changed mesh{*this};
  const auto& v = reference_->vertices(face);
  OwnedFace owned{{}, v, {ownerAfter(v[0]), ownerAfter(v[1]), ownerAfter(v[2])}};
  for (const Index owner : owned.owners) {
    if (owner == kNone) return false;
  }
  if (owned.hasOneOwner()) return true;
  owned.corners = reference_->cornersOf(face);
  if (overlayBound2(mesh, owned, squaredDistance_) <= squaredDistance_) return true;
  return !asksWays_ && !reference_->isHeld(face) && !requiresWays(face) &&
         wholeFace2(mesh, owned) <= squaredDistance_;
}

}  // namespace tufa::reduce
