#include "reduce/certificate.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "reduce/overlay_path.h"

namespace tufa::reduce {
namespace {

constexpr std::size_t kGrain = 8192;
constexpr int kDepth = 12;
// Bounds are tight within this factor and distance.
constexpr float kTight = 1.002f;
constexpr float kTightVoxels = 1e-4f;

// A triangle beside a face of the reference, where the map may jump.
struct Gap {
  Index triangle;
  Index face;
};

// What one range of vertices or faces gives.
struct Measured {
  float largest = 0;
  double sum = 0;
  Index halved = 0, worst = kNone;
  std::vector<Gap> gaps;
  std::vector<Index> beyond;

  void see(float value, Index face, float expected) {
    if (value > largest) largest = value, worst = face;
    if (value > expected) beyond.push_back(face);
  }
};

struct Sphere {
  Vec3f middle;
  float radius;
};

void sortUnique(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

// A radius whose square is finite.
constexpr float kEverywhere = 1e15f;

using Corners = std::array<Vec3f, 3>;

// A bound of the distance from the part of a triangle inside a sphere to the nearest of some
// triangles, by halving: no point of a piece is farther from one of them than the farthest of the
// piece's corners. Distance: d(point, candidate).
template <class Distance>
class Halving {
 public:
  Halving(Distance distance, const Sphere& about, float expected)
      : distance_(std::move(distance)), about_(about), expected_(expected) {}

  float bound(const Corners& p, const std::vector<Index>& candidates, int depth = 0) const {
    const Vec3f m = (p[0] + p[1] + p[2]) * (1.0f / 3);
    const float size = std::sqrt(
        std::max({squaredLength(p[0] - m), squaredLength(p[1] - m), squaredLength(p[2] - m)}));
    if (length(m - about_.middle) > size + about_.radius) return 0;
    std::vector<float> away(candidates.size());
    for (std::size_t k = 0; k < candidates.size(); ++k) away[k] = distance_(m, candidates[k]);
    const auto nearest = std::min_element(away.begin(), away.end());
    if (*nearest + size <= expected_) return *nearest + size;  // no distance grows faster
    std::vector<Index> close{candidates[static_cast<std::size_t>(nearest - away.begin())]};
    for (std::size_t k = 0; k < candidates.size(); ++k) {  // others are nowhere the nearest
      if (away[k] <= *nearest + 2 * size && candidates[k] != close[0]) {
        close.push_back(candidates[k]);
      }
    }
    const bool isLast = depth >= kDepth;
    float best = kFar, low[3] = {kFar, kFar, kFar};
    for (const Index candidate : close) {
      float most = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const float at = distance_(p[i], candidate);
        most = std::max(most, at);
        low[i] = std::min(low[i], at);
      }
      best = std::min(best, most);
      if (best <= expected_) return best;
    }
    if (isLast) return best;
    const float lowest = std::max({low[0], low[1], low[2]});
    const bool isInside = length(m - about_.middle) + size <= about_.radius + 1;
    if (isInside && best <= kTight * lowest + kTightVoxels) return best;
    return std::min(best, worstOfQuarters(p, close, depth + 1));
  }

 private:
  static constexpr float kFar = 1e30f;

  float worstOfQuarters(const Corners& p, const std::vector<Index>& candidates, int depth) const {
    const Vec3f a = (p[0] + p[1]) * 0.5f, b = (p[1] + p[2]) * 0.5f, c = (p[2] + p[0]) * 0.5f;
    const Corners quarters[4] = {{p[0], a, c}, {a, p[1], b}, {c, b, p[2]}, {a, b, c}};
    float worst = 0;
    for (const Corners& q : quarters) worst = std::max(worst, bound(q, candidates, depth));
    return worst;
  }

  Distance distance_;
  Sphere about_;
  float expected_;
};

// The largest values of regions, from several threads.
class RegionMaxima {
 public:
  explicit RegionMaxima(const Surface& s)
      : s_(s),
        largest_(s.region.empty() ? 0 : 1 + *std::max_element(s.region.begin(), s.region.end())) {}

  void see(Index triangle, float value) {
    if (!largest_.empty()) raise(largest_[s_.region[triangle]], value);
  }

  // A way over the triangles around some owners.
  void seeAround(const std::array<Index, 3>& owners, const CornersOfVertices& corners,
                 float value) {
    if (largest_.empty()) return;
    for (const Index owner : owners) {
      see(owner, value);
      for (const Index v : s_.triangles[owner].vertices) {
        if (!s_.isOnLine(v)) continue;
        for (const Index c : corners.of(v)) see(c / 3, value);
      }
    }
  }

  std::vector<float> take() { return std::move(largest_); }

 private:
  static void raise(float& largest, float value) {
    const std::atomic_ref<float> shared(largest);
    float was = shared.load(std::memory_order_relaxed);
    while (value > was && !shared.compare_exchange_weak(was, value, std::memory_order_relaxed)) {
    }
  }

  const Surface& s_;
  std::vector<float> largest_;
};

class Measure {
 public:
  Measure(const Surface& s, const ReferenceMesh& reference, float expected, RegionMaxima& regions,
          base::Job& job)
      : s_(s),
        reference_(reference),
        expected_(expected),
        regions_(regions),
        opposite_(oppositeCorners(s.position.size(), s.triangles, job)),
        corners_(s.position.size(), s.triangles) {}

  void vertices(std::size_t begin, std::size_t end, Measured& measured) const {
    for (std::size_t r = begin; r < end; ++r) {
      if (s_.owner[r] == kNone) continue;
      const float d = distance(reference_.positions()[r], s_.owner[r]);
      measured.sum += static_cast<double>(d);
      regions_.see(s_.owner[r], d);
      measured.see(d, reference_.cornerOf(static_cast<Index>(r)) / 3, expected_);
    }
  }

  void faces(std::size_t begin, std::size_t end, Measured& measured) const {
    for (Index f = static_cast<Index>(begin); f < end; ++f) {
      const auto& v = reference_.faces()[f].vertex;
      const OwnedFace face{
          reference_.cornersOf(f), v, {s_.owner[v[0]], s_.owner[v[1]], s_.owner[v[2]]}};
      if (face.hasOneOwner()) continue;
      float way = std::sqrt(overlayBound2(*this, face, expected_ * expected_));
      if (way > expected_) way = halve(f, face, measured);
      regions_.seeAround(face.owners, corners_, way);
      measured.see(way, f, expected_);
    }
  }

  // The way back: from the parts of a triangle about some faces, which the map may not reach, to
  // all faces nearby at reference vertices of the triangles around. From the whole triangle, if
  // there are many. `owned`: for each triangle the reference vertices that it owns.
  void wayBack(std::span<const Gap> gaps, const std::vector<std::vector<Index>>& owned,
               Measured& measured) const {
    constexpr std::size_t kMany = 4;
    if (gaps.size() > kMany) return wayBack(gaps.front(), {{}, kEverywhere}, owned, measured);
    for (const Gap& gap : gaps) {
      const Corners face = reference_.cornersOf(gap.face);
      Sphere about{(face[0] + face[1] + face[2]) * (1.0f / 3), 0};
      for (const Vec3f& p : face) about.radius = std::max(about.radius, length(p - about.middle));
      about.radius += 3 * expected_ + 1;
      wayBack(gap, about, owned, measured);
    }
  }

  // As overlay_path.h sees a mesh.
  Vec3f operator()(Index t, int i) const { return s_.corner(t, static_cast<std::size_t>(i)); }
  [[nodiscard]] Index vertex(Index t, int i) const {
    return s_.triangles[t].vertices[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] Index across(Index t, int i) const {
    const Index c = opposite_[3 * t + static_cast<Index>(i)];
    return c == kNone ? kNone : c / 3;
  }

 private:
  // From what of a triangle is in a sphere.
  void wayBack(const Gap& gap, const Sphere& about, const std::vector<std::vector<Index>>& owned,
               Measured& measured) const {
    const float reach = about.radius + 2 * expected_ + 1;
    std::vector<Index> candidates{gap.face};
    for (const Index t : trianglesAround({&gap.triangle, 1})) {
      for (const Index r : owned[t]) {
        if (squaredLength(reference_.positions()[r] - about.middle) > reach * reach) continue;
        reference_.allAround(r, [&](Index f) {
          candidates.push_back(f);
          return true;
        });
      }
    }
    sortUnique(candidates);
    const auto toFace = [&](Vec3f q, Index f) { return reference_.distance(f, q); };
    const Index t = gap.triangle;
    const Corners p{s_.corner(t, 0), s_.corner(t, 1), s_.corner(t, 2)};
    const float back = Halving(toFace, about, expected_).bound(p, candidates);
    regions_.see(t, back);
    measured.see(back, gap.face, expected_);
  }

  // The way from a face to the triangles around its owners. Notes where the map may jump.
  float halve(Index f, const OwnedFace& face, Measured& measured) const {
    ++measured.halved;
    const std::vector<Index> around = trianglesAround(face.owners);
    for (const Index t : around) {
      if (isBetween(t, face.owners)) measured.gaps.push_back({t, f});
    }
    const auto toTriangle = [&](Vec3f q, Index t) { return distance(q, t); };
    return Halving(toTriangle, Sphere{{}, kEverywhere}, expected_).bound(face.corners, around);
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
  std::vector<Index> opposite_;
  CornersOfVertices corners_;
};

}  // namespace

Certificate certify(const Surface& s, const ReferenceMesh& reference, float expected,
                    base::Job& job) {
  RegionMaxima regions(s);
  const Measure measure(s, reference, expected, regions, job);
  const std::size_t vertices = s.owner.size(), faces = reference.faces().size();
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
  std::vector<Gap> gaps;
  for (const Measured& p : parts) gaps.insert(gaps.end(), p.gaps.begin(), p.gaps.end());
  if (!gaps.empty()) {
    std::vector<std::vector<Index>> owned(s.triangles.size());
    for (Index r = 0; r < vertices; ++r) {
      if (s.owner[r] != kNone) owned[s.owner[r]].push_back(r);
    }
    // Those of a triangle together.
    std::stable_sort(gaps.begin(), gaps.end(),
                     [](const Gap& x, const Gap& y) { return x.triangle < y.triangle; });
    std::vector<std::size_t> first;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
      if (i == 0 || gaps[i].triangle != gaps[i - 1].triangle) first.push_back(i);
    }
    const std::size_t groups = first.size();
    first.push_back(gaps.size());
    parts.resize(a + b + groups);
    job.forRanges(groups, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        measure.wayBack({gaps.data() + first[i], gaps.data() + first[i + 1]}, owned,
                        parts[a + b + i]);
      }
    });
  }
  Certificate all;
  double sum = 0;
  for (const Measured& p : parts) {
    if (p.largest > all.largest) all.largest = p.largest, all.worst = p.worst;
    sum += p.sum;
    all.halved += p.halved;
    all.beyond.insert(all.beyond.end(), p.beyond.begin(), p.beyond.end());
  }
  sortUnique(all.beyond);
  all.ofRegion = regions.take();
  all.mean = vertices == 0 ? 0 : static_cast<float>(sum / static_cast<double>(vertices));
  return all;
}

}  // namespace tufa::reduce
