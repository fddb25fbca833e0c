#include "reduce/part.h"

#include <algorithm>
#include <bit>

#include "base/shrink.h"

namespace tufa::reduce {

void Part::load(const Surface& surface, const ReferenceMesh& reference, const Partition& partition,
                Index number, const PhaseLimits& limits) {
  surface_ = &surface;
  reference_ = &reference;
  partition_ = &partition;
  number_ = number;
  limits_ = limits;
  setDistance(limits.distance);
  box_ = partition.box(number);
  const auto vertices = partition.vertices(number);
  vertexCount_ = static_cast<Index>(vertices.size());
  position_.resize(vertexCount_), axis_.resize(vertexCount_);
  flags_.resize(vertexCount_), inner_.resize(vertexCount_), face_.resize(vertexCount_);
  corner_.resize(vertexCount_);
  version_.assign(vertexCount_, 0), stamp_.assign(vertexCount_, 0);
  moved_.assign(vertexCount_, 0), merged_.assign(vertexCount_, 0);
  now_ = mergedNow_ = 0;
  for (Index i = 0; i < vertexCount_; ++i) {
    const Index v = vertices[i];
    position_[i] = surface.position[v], axis_[i] = surface.axis[v].vector();
    flags_[i] = surface.flags[v];
    face_[i] = faceOf(surface, reference, v), inner_[i] = partition.isInner(v);
  }
  triangleIds_ = partition.triangles(number);
  loadTables(surface);
  matchOpposites();
  loadQuadrics();
  loadSamples(surface);
  loadLines(surface);
  lowest_ = kBuckets;
  done_ = 0;
  hasBoxList_ = false;
  boxList_.clear();
}

void Part::loadTables(const Surface& surface) {
  triangleCount_ = static_cast<Index>(triangleIds_.size());
  vertex_.resize(3 * triangleCount_);
  for (Index t = 0; t < triangleCount_; ++t) {
    for (Index i = 0; i < 3; ++i) {
      const Index v = partition_->localVertex(surface.triangles[triangleIds_[t]].vertices[i]);
      vertex_[3 * t + i] = v, corner_[v] = 3 * t + i;
    }
  }
}

// An edge that comes from another vertex meets the one that goes back there.
void Part::matchOpposites() {
  const Index corners = 3 * triangleCount_;
  opposite_.assign(corners, kNone);
  auto& first = firstScratch_;
  first.assign(vertexCount_ + 1, 0);
  for (const Index v : vertex_) ++first[v + 1];
  for (Index i = 0; i < vertexCount_; ++i) first[i + 1] += first[i];
  edgeScratch_.resize(corners);  // by start: end and opposite corner
  for (Index c = 0; c < corners; ++c) {
    edgeScratch_[first[vertex_[nextCorner(c)]]++] = {vertex_[previousCorner(c)], c};
  }
  for (Index i = vertexCount_; i > 0; --i) first[i] = first[i - 1];
  first[0] = 0;
  for (Index c = 0; c < corners; ++c) {
    const Index from = vertex_[nextCorner(c)], to = vertex_[previousCorner(c)];
    for (Index j = first[to]; j < first[to + 1]; ++j) {
      if (edgeScratch_[j][0] == from) opposite_[c] = edgeScratch_[j][1];
    }
  }
}

// Of the planes of the triangles as they are now. Those that a vertex has gathered in phases before
// would hold it back, although the distance guard knows better how far it may go (memoryless
// simplification, Lindstrom and Turk 1998).
void Part::loadQuadrics() {
  quadric_.assign(vertexCount_, {});
  for (Index t = 0; t < triangleCount_; ++t) {
    Vec3f p[3];
    triangleAt(t, p);
    const Vec3f normal = cross(p[1] - p[0], p[2] - p[0]);
    const float l = length(normal);
    if (!(l > 0)) continue;
    for (Index i = 0; i < 3; ++i) quadric_[vertex_[3 * t + i]].addPlane(normal * (1 / l), l / 6);
  }
}

void Part::loadSamples(const Surface& surface) {
  firstSample_.assign(triangleCount_, kNone);
  wasFar_.assign(triangleCount_, 0);
  sampleIds_ = surface.isWhole ? partition_->vertices(number_) : partition_->samples(number_);
  const auto renew = [&](auto& vector) {
    if (vector.capacity() < sampleIds_.size()) {
      base::release(vector);
      base::reserveLarge(vector, sampleIds_.size());
    }
    vector.resize(sampleIds_.size());
  };
  renew(samples_), renew(isRough_), renew(owners_);
  std::fill(owners_.begin(), owners_.end(), kNone);
  base::release(takers_);
  if (surface.isWhole) {
    findOwnersAtVertices(surface);
  } else {
    for (Index s = 0; s < sampleIds_.size(); ++s) {
      job_->pollCancelled(s);
      owners_[s] = partition_->localTriangle(surface.owner[sampleIds_[s]]);
    }
  }
  hasRough_ = false;
  std::size_t loaded = 0, bent = 0;
  for (Index s = 0; s < sampleIds_.size(); ++s) {
    job_->pollCancelled(s);
    const Index r = sampleIds_[s], t = owners_[s];
    if (t == kNone) continue;
    samples_[s] = {reference_->positions()[r], firstSample_[t]};
    isRough_[s] = reference_->isRough(r) ? kRough : 0;
    hasRough_ |= isRough_[s] != 0;
    ++loaded, bent += reference_->isBent(r) ? 1 : 0;
    firstSample_[t] = s;
  }
  isBent_ = 4 * bent >= 3 * loaded;
}

// Of the samples of a surface that is whole, those whose owners are in the part.
void Part::findOwnersAtVertices(const Surface& surface) {
  const auto vertices = partition_->vertices(number_);
  for (Index c = 0; c < vertex_.size(); ++c) {
    const Index v = vertex_[c];
    if (surface.owner[vertices[v]] == triangleIds_[c / 3]) owners_[v] = c / 3;
  }
}

void Part::store(Surface& surface, std::vector<std::uint8_t>& dead) {
  const auto vertices = partition_->vertices(number_);
  for (Index i = 0; i < vertexCount_; ++i) {
    const Index v = vertices[i];
    if (inner_[i] != 0) surface.axis[v] = base::Direction(axis_[i]), surface.flags[v] = flags_[i];
    if (moved_[i] != 0) stored_.moved.push_back({v, position_[i], face_[i]});
  }
  for (Index t = 0; t < triangleCount_; ++t) {
    const Index own = triangleIds_[t];
    if (isDead(t)) {
      dead[own] = 1;
      continue;
    }
    Triangle now;
    for (Index i = 0; i < 3; ++i) now.vertices[i] = vertices[vertex_[3 * t + i]];
    if (!(now == surface.triangles[own])) stored_.changed.push_back({own, now});
    for (Index s = firstSample_[t]; s != kNone; s = samples_[s].next) {
      surface.owner[sampleIds_[s]] = own;
    }
  }
  storeLines(surface);
}

void Part::push(float cost, const Candidate& candidate) {
  const Index bucket = std::bit_cast<Index>(std::max(cost, 0.0f)) >> 22;  // two for each octave
  buckets_[bucket].push_back(candidate);
  lowest_ = std::min(lowest_, bucket);
}

bool Part::pop(Candidate& candidate) {
  for (; lowest_ < kBuckets; ++lowest_) {
    auto& bucket = buckets_[lowest_];
    if (heads_[lowest_] < bucket.size()) {
      candidate = bucket[heads_[lowest_]++];
      return true;
    }
    bucket.clear();
    heads_[lowest_] = 0;
  }
  return false;
}

// Puts the samples that an attempt has gathered in the lists of their new owners.
void Part::giveSamples() {
  for (const Taken& taken : taken_) {
    Index& first = firstSample_[taken.triangle];
    samples_[taken.sample].next = first;
    owners_[taken.sample] = taken.triangle;
    first = taken.sample;
    if (!asksWays_) continue;
    isRough_[taken.sample] = kWays;
    hasRough_ = true;
    withWays_.push_back(sampleIds_[taken.sample]);
  }
}

// Numbers from triangleCount_ on are foreign triangles'.
void Part::triangleAt(Index t, Vec3f* p) const {
  if (t < triangleCount_) {
    for (Index i = 0; i < 3; ++i) p[i] = position_[vertex_[3 * t + i]];
  } else {
    const Index own = partition_->foreign(number_)[t - triangleCount_];
    for (std::size_t i = 0; i < 3; ++i) p[i] = surface_->corner(own, i);
  }
}

}  // namespace tufa::reduce
