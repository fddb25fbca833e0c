#include <algorithm>
#include <array>
#include <functional>
#include <mutex>
#include <numeric>
#include <utility>

#include "base/collect.h"
#include "base/huge_pages.h"
#include "base/parallel_sort.h"
#include "intersect/surface.h"
#include "intersect/triangle_pair.h"

namespace tufa::intersect {

using base::Box;

namespace {

// Whether a plane certainly separates two polygons but for what they share, even if each vertex
// moves by half of `margin`; a quick answer for most that share two vertices or less. Quads need
// not be plane: their hulls are separated.
bool areSeparated(std::span<const Position> positions, Corners a, Corners b, double margin) {
  std::array<Position, 4> ofA, ofB;
  std::array<Position, 2> common;
  std::size_t countA = 0, shared = 0;
  for (const VertexIndex vertex : a) {
    if (std::find(b.begin(), b.end(), vertex) == b.end()) {
      ofA[countA++] = positions[vertex];
    } else {
      if (shared == 2) return false;
      common[shared++] = positions[vertex];
    }
  }
  std::size_t countB = 0;
  for (const VertexIndex vertex : b) {
    if (std::find(a.begin(), a.end(), vertex) == a.end()) ofB[countB++] = positions[vertex];
  }
  const std::span<const Position> ownA(ofA.data(), countA), ownB(ofB.data(), countB);
  if (shared == 2) return areSeparatedAlong(common[0], common[1], ownA, ownB, margin);
  return areSeparatedAt(shared == 1 ? common[0] : positions[a[0]], ownA, ownB, shared == 1, margin);
}

// The same for the two triangles of a quad.
bool areHalvesSeparated(std::span<const Position> positions, Corners v, double margin) {
  if (v.size() != 4) return true;
  const Position& a = positions[v[1]];
  const Position& b = positions[v[3]];
  return areSeparatedAlong(positions[v[0]], positions[v[2]], {&a, 1}, {&b, 1}, margin);
}

}  // namespace

bool intersectElsewhere(std::span<const Position> positions, Corners a, Corners b, bool same) {
  std::array<Triangle, 2> ta, tb;
  const int countA = trianglesOf(a, ta), countB = trianglesOf(b, tb);
  if (same) return countA == 2 && intersectElsewhere(positions, ta[0], ta[1]);
  if (areSeparated(positions, a, b, 0)) return false;
  for (int i = 0; i < countA; ++i) {
    for (int j = 0; j < countB; ++j) {
      if (intersectElsewhere(positions, ta[i], tb[j])) return true;
    }
  }
  return false;
}

std::vector<PolygonPair> intersectingAmong(const std::vector<PolygonPair>& pairs, const Mesh& mesh,
                                           std::span<const Position> positions, base::Job& job) {
  const auto intersect = [&](std::uint32_t k) {
    const auto& [a, b] = pairs[k];
    return intersectElsewhere(positions, base::cornersOf(mesh, a), base::cornersOf(mesh, b),
                              a == b);
  };
  std::vector<PolygonPair> found;
  for (const std::uint32_t i : base::collectIf(job, pairs.size(), intersect, 1024)) {
    found.push_back(pairs[i]);
  }
  return found;
}

namespace {

struct Candidate {
  PolygonIndex polygon;
  Box box;
};

// Runs, and polygons of a run, that are compared with the candidates near them at once.
constexpr std::size_t kRunsAtOnce = 8;
constexpr PolygonIndex kAtOnce = 4;

using Matters = std::function<bool(PolygonIndex, PolygonIndex)>;

// What is looked for. Candidates' boxes are larger by `margin`.
struct Search {
  const Surface& surface;
  const Matters& matters;
  double margin;
  bool keepsClose;
};

// The lower polygon first, so that rounding is the same whichever is the candidate.
void test(const Search& search, const PolygonPair& pair, ClosePairs& found) {
  const std::vector<Position>& positions = search.surface.mesh().positions;
  const Corners a = search.surface.corners(pair.a), b = search.surface.corners(pair.b);
  const bool same = pair.a == pair.b;
  const bool separated = same ? areHalvesSeparated(positions, a, search.margin)
                              : areSeparated(positions, a, b, search.margin);
  if (separated) return;
  if (search.keepsClose) found.close.push_back(pair);
  if (intersectElsewhere(positions, a, b, same)) found.intersecting.push_back(pair);
}

// Without branches: which of two neighbours meet is hard to foretell.
bool meet(const Box& a, const Box& b) {
  int apart = 0;
  for (int axis = 0; axis < 3; ++axis) {
    apart |= static_cast<int>(a.lower[axis] > b.upper[axis]);
    apart |= static_cast<int>(b.lower[axis] > a.upper[axis]);
  }
  return apart == 0;
}

// Finds the pairs of the polygons of one section after another with the candidates around it. Boxes
// are compared in steps, each of a part of what the step before has left: section, several runs,
// run, several polygons, polygon. So a candidate is compared with few polygons that it does not
// touch.
class SectionSearch {
 public:
  SectionSearch(const Search& search, const base::Bvh& tree,
                const std::vector<PolygonIndex>& candidates)
      : search_(search), surface_(search.surface), tree_(tree), candidates_(candidates) {}

  void run(std::size_t section) {
    around_.clear();
    tree_.itemsMeeting(surface_.sectionBox(section), [&](std::uint32_t i, const Box& box) {
      around_.push_back({candidates_[i], box});
    });
    if (around_.empty()) return;
    std::vector<std::uint32_t>& all = near_[0];
    all.resize(around_.size());
    std::iota(all.begin(), all.end(), 0U);
    const std::size_t end = surface_.sectionEnd(section);
    for (std::size_t first = section * Surface::kSection; first < end; first += kRunsAtOnce) {
      const std::size_t last = std::min(first + kRunsAtOnce, end);
      Box box = Box::empty();
      for (std::size_t run = first; run < last; ++run) box.add(surface_.runBox(run));
      if (!narrow(1, box)) continue;
      for (std::size_t run = first; run < last; ++run) {
        if (narrow(2, surface_.runBox(run))) pairsOfRun(run);
      }
    }
  }
  [[nodiscard]] const ClosePairs& found() const { return found_; }

 private:
  // Takes those of the step before that meet a box. Whether there are any.
  bool narrow(std::size_t step, const Box& box) {
    const std::vector<std::uint32_t>& before = near_[step - 1];
    std::vector<std::uint32_t>& near = near_[step];
    near.resize(before.size());
    std::size_t count = 0;
    for (const std::uint32_t i : before) {
      near[count] = i;
      count += meet(box, around_[i].box) ? 1 : 0;
    }
    near.resize(count);
    return count > 0;
  }

  void pairsOfRun(std::size_t run) {
    const PolygonIndex begin = surface_.runBegin(run), end = surface_.runEnd(run);
    std::array<bool, Surface::kRun> isCandidate{};
    for (const std::uint32_t i : near_[2]) {
      const PolygonIndex polygon = around_[i].polygon;
      if (polygon >= begin && polygon < end) isCandidate[polygon - begin] = true;
    }
    for (PolygonIndex first = begin; first < end; first += kAtOnce) {
      const PolygonIndex last = std::min(first + kAtOnce, end);
      std::array<Box, kAtOnce> boxes;
      Box all = Box::empty();
      for (PolygonIndex p = first; p < last; ++p) {
        boxes[p - first] = surface_.box(p);
        all.add(boxes[p - first]);
      }
      if (!narrow(3, all)) continue;
      for (PolygonIndex p = first; p < last; ++p) {
        if (!narrow(4, boxes[p - first])) continue;
        for (const std::uint32_t i : near_[4]) {
          const PolygonIndex other = around_[i].polygon;
          // Of two candidates, the higher one is found from the lower one.
          if (isCandidate[p - begin] && other < p) continue;
          if (search_.matters && !search_.matters(p, other)) continue;
          test(search_, {std::min(p, other), std::max(p, other)}, found_);
        }
      }
    }
  }

  const Search& search_;
  const Surface& surface_;
  const base::Bvh& tree_;
  const std::vector<PolygonIndex>& candidates_;
  std::vector<Candidate> around_;
  std::array<std::vector<std::uint32_t>, 5> near_;  // of these, after each step
  ClosePairs found_;
};

ClosePairs find(const Search& search, const std::vector<PolygonIndex>& candidates, base::Job& job) {
  const Surface& surface = search.surface;
  std::vector<Box> boxes;
  base::resizeLarge(boxes, candidates.size(), job);
  job.forRanges(candidates.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      boxes[i] = surface.box(candidates[i]);
      boxes[i].lower -= Vec3(search.margin);
      boxes[i].upper += Vec3(search.margin);
    }
  });
  // The tree is over the candidates, which are few; sections of all polygons are looked up in it.
  // Sorting at the end makes the result independent of the threads.
  const base::Bvh tree(std::move(boxes), job);
  ClosePairs all;
  std::mutex mutex;
  job.forRanges(surface.sectionCount(), 1, [&](std::size_t begin, std::size_t end) {
    SectionSearch some(search, tree, candidates);
    for (std::size_t section = begin; section < end; ++section) some.run(section);
    const ClosePairs& found = some.found();
    const std::scoped_lock lock(mutex);
    all.intersecting.insert(all.intersecting.end(), found.intersecting.begin(),
                            found.intersecting.end());
    all.close.insert(all.close.end(), found.close.begin(), found.close.end());
  });
  base::parallelSort(all.intersecting.begin(), all.intersecting.end(), std::less<>());
  base::parallelSort(all.close.begin(), all.close.end(), std::less<>());
  return all;
}

}  // namespace

ClosePairs findClosePairs(const Surface& surface, const std::vector<PolygonIndex>& candidates,
                          double margin, base::Job& job, const Matters& matters) {
  return find({surface, matters, margin, true}, candidates, job);
}

std::vector<PolygonPair> findPairs(const Surface& surface,
                                   const std::vector<PolygonIndex>& candidates, base::Job& job,
                                   const Matters& matters) {
  return find({surface, matters, 0, false}, candidates, job).intersecting;
}

}  // namespace tufa::intersect
