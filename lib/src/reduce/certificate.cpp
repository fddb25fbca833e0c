#include "reduce/certificate.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "reduce/halving.h"
#include "reduce/overlay_path.h"
#include "reduce/overlay_surface.h"
#include "reduce/uncovered.h"

namespace tufa::reduce {
namespace {

constexpr std::size_t kGrain = 8192;
// Voxels; a larger tolerance is many faces wide.
constexpr float kLarge = 2;
// Voxels; where less is expected, rounding may take as much.
constexpr float kRounding = 1e-4f;

// A triangle beside a face of the reference, where the map may jump.
struct Gap {
  Index triangle;
  Index face;
};

// What one range of vertices or faces gives.
struct Measured {
  float largest = 0;
  float mostOver = 1;  // the largest distance in what is expected there
  double sum = 0;
  Index worst = kNone;
  std::vector<Index> open;  // faces without a way within what is expected
  std::vector<Index> beyond;

  void see(float value, Index face, float limit) {
    if (value > largest) largest = value, worst = face;
    if (value > limit) beyond.push_back(face), mostOver = std::max(mostOver, value / limit);
  }
};

void sortUnique(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

// The largest values of regions, from several threads.
class RegionMaxima {
 public:
  explicit RegionMaxima(const Surface& s)
      : s_(s),
        largest_(s.region.empty() ? 0 : 1 + *std::max_element(s.region.begin(), s.region.end())),
        atVertex_(largest_.empty() ? 0 : s.position.size()) {}

  void see(Index triangle, float value) {
    if (!largest_.empty()) raise(largest_[s_.region[triangle]], value);
  }

  // A way over the triangles around some owners: at lines those of other regions are among them.
  void seeAround(const std::array<Index, 3>& owners, float value) {
    if (largest_.empty()) return;
    for (const Index owner : owners) {
      see(owner, value);
      for (const Index v : s_.triangles[owner].vertices) {
        if (s_.isOnLine(v)) raise(atVertex_[v], value);
      }
    }
  }

  std::vector<float> take(const CornersOfVertices& corners) {
    for (Index v = 0; v < atVertex_.size(); ++v) {
      if (atVertex_[v] == 0) continue;
      for (const Index c : corners.of(v)) see(c / 3, atVertex_[v]);
    }
    return std::move(largest_);
  }

 private:
  static void raise(float& largest, float value) {
    const std::atomic_ref<float> shared(largest);
    float was = shared.load(std::memory_order_relaxed);
    while (value > was && !shared.compare_exchange_weak(was, value, std::memory_order_relaxed)) {
    }
  }

  const Surface& s_;
  std::vector<float> largest_;
  std::vector<float> atVertex_;  // of lines
};

class Measure {
 public:
  Measure(const Surface& s, const ReferenceMesh& reference, float expected, RegionMaxima& regions,
          base::Job& job)
      : s_(s),
        reference_(reference),
        expected_(expected),
        regions_(regions),
        owner_(s.owner),
        corners_(s.position.size(), s.triangles, job),
        opposite_(oppositeCorners(s.triangles, corners_, job)),
        overlay_{s, opposite_} {}

  void vertices(std::size_t begin, std::size_t end, Measured& measured) const {
    for (std::size_t r = begin; r < end; ++r) {
      if (owner_[r] == kNone) continue;
      const float d = distance(reference_.positions()[r], owner_[r]);
      measured.sum += static_cast<double>(d);
      regions_.see(owner_[r], d);
      const float limit = limitAt(static_cast<Index>(r));
      if (d > std::min(measured.largest, limit)) {
        measured.see(d, reference_.cornerOf(static_cast<Index>(r)) / 3, limit);
      }
    }
  }

  void faces(std::size_t begin, std::size_t end, Measured& measured) const {
    for (Index f = static_cast<Index>(begin); f < end; ++f) {
      if (!passes(f, measured)) measured.open.push_back(f);
    }
  }

  // Looks for other owners of a face's corners, with which it and all faces around the corner have
  // ways: a corner beside an edge of the surface may be near both sides. Returns whether it has
  // one.
  bool findOwners(Index f, Measured& measured) {
    if (passes(f, measured)) return true;  // by another owner that was found for a neighbour
    const OwnedFace face = owned(f);
    const std::vector<Index> around = trianglesAround(face.owners);
    for (std::size_t i = 0; i < 3; ++i) {
      const Index r = face.vertices[i];
      if (reference_.isAtBorder(r)) continue;
      for (const auto& [d, t] : nearest(face.corners[i], limitOf(f), around)) {
        owner_[r] = t;
        Measured there;
        if (t != face.owners[i] && passes(f, there) &&
            reference_.allAround(r, [&](Index g) { return passes(g, there); })) {
          regions_.see(t, d);
          measured.see(std::max(d, there.largest), f, limitOf(f));
          return true;
        }
      }
      owner_[r] = face.owners[i];
    }
    return false;
  }

  // The way from a face to the triangles around its owners, by halving. Notes where the map may
  // jump.
  void halve(Index f, std::vector<Gap>& gaps, Measured& measured) const {
    const OwnedFace face = owned(f);
    const std::vector<Index> around = trianglesAround(face.owners);
    for (const Index t : around) {
      if (isBetween(t, face.owners)) gaps.push_back({t, f});
    }
    const auto toTriangle = [&](Vec3f q, Index t) { return distance(q, t); };
    const float limit = limitOf(f);
    const float way =
        Halving(toTriangle, Sphere{{}, kEverywhere}, limit).bound(face.corners, around);
    regions_.seeAround(face.owners, way);
    measured.see(way, f, limit);
  }

  // The reference vertices that each triangle owns.
  [[nodiscard]] std::vector<std::vector<Index>> verticesOfOwners() const {
    std::vector<std::vector<Index>> vertices(s_.triangles.size());
    for (Index r = 0; r < owner_.size(); ++r) {
      if (owner_[r] != kNone) vertices[owner_[r]].push_back(r);
    }
    return vertices;
  }

  // The way back: from the parts of a triangle about some faces, which the map may not reach, to
  // all faces nearby at reference vertices of the triangles around. From the whole triangle, if
  // that is less. `owned`: for each triangle the reference vertices that it owns.
  void wayBack(std::span<const Gap> gaps, const std::vector<std::vector<Index>>& owned,
               Measured& measured) const {
    const Index t = gaps.front().triangle;
    const Vec3f a = s_.corner(t, 0), b = s_.corner(t, 1), c = s_.corner(t, 2);
    const float area = length(cross(b - a, c - a)) / 2;
    std::vector<Sphere> parts;
    float partsArea = 0;
    for (const Gap& gap : gaps) {
      const Corners face = reference_.cornersOf(gap.face);
      Sphere about{(face[0] + face[1] + face[2]) * (1.0f / 3), 0};
      for (const Vec3f& p : face) about.radius = std::max(about.radius, length(p - about.middle));
      about.radius += 2 * limitOf(gap.face) + kBeyond;
      parts.push_back(about);
      partsArea += 3 * about.radius * about.radius;
    }
    if (partsArea > area) return wayBack(gaps.front(), {{}, kEverywhere}, owned, measured);
    for (std::size_t i = 0; i < gaps.size(); ++i) wayBack(gaps[i], parts[i], owned, measured);
  }

  // The way back from a whole triangle to faces among which the nearest ones are.
  void wayBack(Index triangle, const FacesNear& faces, Measured& measured) const {
    const Corners p{s_.corner(triangle, 0), s_.corner(triangle, 1), s_.corner(triangle, 2)};
    const std::vector<Index> near = faces.of(p);
    const float limit = limitOf(near.front());
    seeWayBack(triangle, near.front(), boundTo(near, p, {{}, kEverywhere}, limit), measured);
  }

  [[nodiscard]] const CornersOfVertices& corners() const { return corners_; }
  [[nodiscard]] Uncovered uncovered(std::span<const Index> gaps, base::Job& job) const {
    return findUncovered(overlay_, corners_, reference_, owner_, gaps, expected_, job);
  }

 private:
  // What is expected at a reference vertex. Of a face it is the most at one of its vertices, as a
  // guard may see that one alone.
  [[nodiscard]] float limitAt(Index r) const {
    if (!reference_.hasScales()) return expected_;
    return std::max(expected_ * reference_.promisedScaleAt(r), kRounding);
  }
  [[nodiscard]] float limitOf(Index f) const {
    const auto& v = reference_.vertices(f);
    return std::max({limitAt(v[0]), limitAt(v[1]), limitAt(v[2])});
  }

  // From what of a triangle is in a sphere. With a large tolerance a few of the faces nearby do for
  // most, as each of them gives a bound.
  void wayBack(const Gap& gap, const Sphere& about, const std::vector<std::vector<Index>>& owned,
               Measured& measured) const {
    const Index t = gap.triangle;
    const Corners p{s_.corner(t, 0), s_.corner(t, 1), s_.corner(t, 2)};
    float back = kFar2;
    const float limit = limitOf(gap.face);
    if (limit >= kLarge) back = boundTo(someFacesNear(gap, about, owned), p, about, limit);
    if (back > limit) back = boundTo(allFacesNear(gap, about, owned), p, about, limit);
    seeWayBack(t, gap.face, back, measured);
  }

  [[nodiscard]] float boundTo(const std::vector<Index>& faces, const Corners& p,
                              const Sphere& about, float limit) const {
    const auto toFace = [&](Vec3f q, Index f) { return reference_.distance(f, q); };
    return Halving(toFace, about, limit).bound(p, faces);
  }

  void seeWayBack(Index triangle, Index face, float back, Measured& measured) const {
    regions_.see(triangle, back);
    measured.see(back, face, limitOf(face));
  }

  // Calls f(vertex) for the reference vertices of the triangles around a gap's that are so near a
  // sphere that a face there may be the nearest.
  template <class F>
  void forVerticesNear(const Gap& gap, const Sphere& about,
                       const std::vector<std::vector<Index>>& owned, F&& f) const {
    const float reach = about.radius + kBeyond + 2 * limitOf(gap.face) + 1;
    for (const Index t : trianglesAround({&gap.triangle, 1})) {
      for (const Index r : owned[t]) {
        if (squaredLength(reference_.positions()[r] - about.middle) <= reach * reach) f(r);
      }
    }
  }

  [[nodiscard]] std::vector<Index> allFacesNear(
      const Gap& gap, const Sphere& about, const std::vector<std::vector<Index>>& owned) const {
    std::vector<Index> faces{gap.face};
    forVerticesNear(gap, about, owned, [&](Index r) {
      reference_.allAround(r, [&](Index f) {
        faces.push_back(f);
        return true;
      });
    });
    sortUnique(faces);
    return faces;
  }

  // One of each cube of a share of the tolerance.
  [[nodiscard]] std::vector<Index> someFacesNear(
      const Gap& gap, const Sphere& about, const std::vector<std::vector<Index>>& owned) const {
    constexpr float kShare = 0.125f;
    const float perCube = 1 / (kShare * limitOf(gap.face));
    std::vector<Index> faces{gap.face};
    std::unordered_set<std::uint64_t> seen;
    forVerticesNear(gap, about, owned, [&](Index r) {
      const Vec3f at = (reference_.positions()[r] - about.middle) * perCube;
      std::uint64_t cube = 0;
      for (int axis = 0; axis < 3; ++axis) {
        constexpr float kMiddle = 1 << 20;
        const float cell = std::clamp(std::floor(at[axis]) + kMiddle, 0.0f, 2 * kMiddle - 1);
        cube = cube << 21 | static_cast<std::uint64_t>(cell);
      }
      if (seen.insert(cube).second) faces.push_back(reference_.cornerOf(r) / 3);
    });
    return faces;
  }

  [[nodiscard]] OwnedFace owned(Index f) const {
    const auto& v = reference_.vertices(f);
    return {reference_.cornersOf(f), v, {owner_[v[0]], owner_[v[1]], owner_[v[2]]}};
  }

  // The nearest of some triangles within a limit, with their distances.
  [[nodiscard]] std::vector<std::pair<float, Index>> nearest(
      Vec3f p, float limit, const std::vector<Index>& triangles) const {
    constexpr std::size_t kMost = 6;
    std::vector<std::pair<float, Index>> found;
    for (const Index t : triangles) {
      const float d = distance(p, t);
      if (d <= limit) found.emplace_back(d, t);
    }
    std::sort(found.begin(), found.end());
    found.resize(std::min(found.size(), kMost));
    return found;
  }

  // Whether there is a way from a face to its owners within what is expected.
  bool passes(Index f, Measured& measured) const {
    const auto& v = reference_.vertices(f);
    if (owner_[v[0]] == owner_[v[1]] && owner_[v[1]] == owner_[v[2]]) return true;
    const OwnedFace face = owned(f);
    const float limit = limitOf(f), way = std::sqrt(overlayBound2(overlay_, face, limit * limit));
    if (!(way <= limit)) return false;
    regions_.seeAround(face.owners, way);
    measured.see(way, f, limit);
    return true;
  }

  [[nodiscard]] float distance(Vec3f p, Index t) const {
    return std::sqrt(
        squaredDistanceToTriangle(p, s_.corner(t, 0), s_.corner(t, 1), s_.corner(t, 2)));
  }

  // Whether t is an owner or touches two of them: what lies between, where a map may jump.
  [[nodiscard]] bool isBetween(Index t, const std::array<Index, 3>& owners) const {
    int touched = 0;
    for (const Index owner : owners) {
      if (t == owner) return true;
      bool isCommon = false;
      for (const Index v : s_.triangles[t].vertices) {
        for (const Index w : s_.triangles[owner].vertices) isCommon |= v == w;
      }
      touched += isCommon;
    }
    return touched >= 2;
  }

  // All triangles that have a vertex in common with one of these.
  [[nodiscard]] std::vector<Index> trianglesAround(std::span<const Index> triangles) const {
    std::vector<Index> around;
    for (const Index t : triangles) {
      for (const Index v : s_.triangles[t].vertices) {
        for (const Index c : corners_.of(v)) around.push_back(c / 3);
      }
    }
    sortUnique(around);
    return around;
  }

  const Surface& s_;
  const ReferenceMesh& reference_;
  float expected_;
  RegionMaxima& regions_;
  std::vector<Index> owner_;
  CornersOfVertices corners_;
  std::vector<Index> opposite_;
  OverlaySurface overlay_;
};

// Calls body(i, measured) for each i, with what some of them measure behind what there is.
template <class Body>
void measureEach(std::size_t count, std::size_t grain, std::vector<Measured>& parts, base::Job& job,
                 const Body& body) {
  const std::size_t done = parts.size(), ranges = (count + grain - 1) / grain;
  parts.resize(done + ranges);
  job.forRanges(ranges, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t range = begin; range < end; ++range) {
      const std::size_t last = std::min(count, (range + 1) * grain);
      for (std::size_t i = range * grain; i < last; ++i) body(i, parts[done + range]);
    }
  });
}

}  // namespace

Certificate certify(const Surface& s, const ReferenceMesh& reference, float expected,
                    base::Job& job) {
  RegionMaxima regions(s);
  Measure measure(s, reference, expected, regions, job);
  const std::size_t vertices = s.owner.size(), faces = reference.faceCount();
  const std::size_t a = (vertices + kGrain - 1) / kGrain, b = (faces + kGrain - 1) / kGrain;
  std::vector<Measured> parts(a + b);  // their limits, and so the sums, do not depend on threads
  job.forRanges(a + b, 1, [&](std::size_t firstPart, std::size_t endPart) {
    for (std::size_t i = firstPart; i < endPart; ++i) {
      const std::size_t begin = (i < a ? i : i - a) * kGrain;
      if (i < a) {
        measure.vertices(begin, std::min(vertices, begin + kGrain), parts[i]);
      } else {
        measure.faces(begin, std::min(faces, begin + kGrain), parts[i]);
      }
    }
  });
  Certificate all;
  std::vector<Gap> gaps;
  Measured last;
  for (const Measured& p : parts) {
    for (const Index f : p.open) {
      job.checkCancelled(0, 1);
      if (measure.findOwners(f, last)) continue;
      measure.halve(f, gaps, last);
      ++all.halved;
    }
  }
  parts.push_back(last);
  if (!gaps.empty()) {
    const std::vector<std::vector<Index>> owned = measure.verticesOfOwners();
    // Those of a triangle together.
    std::stable_sort(gaps.begin(), gaps.end(),
                     [](const Gap& x, const Gap& y) { return x.triangle < y.triangle; });
    std::vector<std::size_t> first;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      if (i == 0 || gaps[i].triangle != gaps[i - 1].triangle) first.push_back(i);
    }
    const std::size_t groups = first.size();
    first.push_back(gaps.size());
    measureEach(groups, 1, parts, job, [&](std::size_t i, Measured& part) {
      measure.wayBack({gaps.data() + first[i], gaps.data() + first[i + 1]}, owned, part);
    });
  }
  std::vector<Index> jumps;
  for (const Gap& gap : gaps) jumps.push_back(gap.triangle);
  if (const Uncovered uncovered = measure.uncovered(jumps, job); !uncovered.triangles.empty()) {
    const FacesNear near(reference, uncovered.faces, job);
    constexpr std::size_t kTogether = 64;
    measureEach(uncovered.triangles.size(), kTogether, parts, job,
                [&](std::size_t i, Measured& part) {
                  measure.wayBack(uncovered.triangles[i], near, part);
                });
  }
  double sum = 0;
  for (const Measured& p : parts) {
    if (p.largest > all.largest) all.largest = p.largest, all.worst = p.worst;
    all.mostOver = std::max(all.mostOver, p.mostOver);
    sum += p.sum;
    all.beyond.insert(all.beyond.end(), p.beyond.begin(), p.beyond.end());
  }
  sortUnique(all.beyond);
  all.ofRegion = regions.take(measure.corners());
  all.mean = vertices == 0 ? 0 : static_cast<float>(sum / static_cast<double>(vertices));
  return all;
}

}  // namespace tufa::reduce
