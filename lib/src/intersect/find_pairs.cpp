#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

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

// Runs that are compared with the candidates near them at once.
constexpr std::size_t kRunsAtOnce = 8;

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

// A box in single precision, counted from a place near it and no smaller.
struct NearBox {
  std::array<float, 3> lower, upper;

  NearBox(const Box& box, const Vec3& from) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double least = box.lower[static_cast<int>(axis)] - from[static_cast<int>(axis)];
      const double most = box.upper[static_cast<int>(axis)] - from[static_cast<int>(axis)];
      constexpr double kRounding = 0x1p-23;
      lower[axis] = static_cast<float>(least - kRounding * std::abs(least));
      upper[axis] = static_cast<float>(most + kRounding * std::abs(most));
    }
  }
};

// Boxes that are compared with another one together: side by side, and without branches, as which
// of two neighbours meet is hard to foretell.
class NearBoxes {
 public:
  void clear() { resize(0); }
  void add(const NearBox& box, std::uint32_t item) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower_[axis].push_back(box.lower[axis]);
      upper_[axis].push_back(box.upper[axis]);
    }
    items_.push_back(item);
  }

  // The items of the boxes, those of the last takeMeeting() if there was one.
  [[nodiscard]] const std::vector<std::uint32_t>& items() const { return items_; }

  // Takes those of `all` that meet a box. Whether there are any.
  bool takeMeeting(const NearBox& box, const NearBoxes& all) {
    const std::vector<std::uint32_t>& places = findMeeting(box, all);
    resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower_[axis][i] = all.lower_[axis][places[i]];
        upper_[axis][i] = all.upper_[axis][places[i]];
      }
      items_[i] = all.items_[places[i]];
    }
    return !places.empty();
  }

  // The places in `all` of the boxes that meet a box.
  const std::vector<std::uint32_t>& findMeeting(const NearBox& box, const NearBoxes& all) {
    const std::size_t count = all.items_.size();
    apart_.assign(count, 0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float least = box.lower[axis], most = box.upper[axis];
      const float* const lower = all.lower_[axis].data();
      const float* const upper = all.upper_[axis].data();
      for (std::size_t i = 0; i < count; ++i) {
        apart_[i] |= static_cast<std::uint32_t>(lower[i] > most) |
                     static_cast<std::uint32_t>(least > upper[i]);
      }
    }
    places_.resize(count);
    std::size_t found = 0;
    for (std::size_t i = 0; i < count; ++i) {
      places_[found] = static_cast<std::uint32_t>(i);
      found += 1 - apart_[i];
    }
    places_.resize(found);
    return places_;
  }

 private:
  void resize(std::size_t count) {
    for (auto* sides : {&lower_, &upper_}) {
      for (std::vector<float>& side : *sides) side.resize(count);
    }
    items_.resize(count);
  }

  std::array<std::vector<float>, 3> lower_, upper_;
  std::vector<std::uint32_t> items_;
  std::vector<std::uint32_t> apart_, places_;  // of the last search
};

// Finds the pairs of the polygons of one section after another with the candidates around it. Boxes
// are compared in steps, each of a part of what the step before has left: section, several runs,
// run, polygon. So a candidate is compared with few polygons that it does not touch.
class SectionSearch {
 public:
  SectionSearch(const Search& search, const base::Bvh& tree,
                const std::vector<PolygonIndex>& candidates)
      : search_(search), surface_(search.surface), tree_(tree), candidates_(candidates) {}

  void run(std::size_t section) {
    const Box& whole = surface_.sectionBox(section);
    from_ = whole.lower;
    around_.clear();
    boxes_.clear();
    near_[0].clear();
    tree_.itemsMeeting(whole, [&](std::uint32_t i, const Box& box) {
      near_[0].add({box, from_}, static_cast<std::uint32_t>(around_.size()));
      around_.push_back(candidates_[i]);
      boxes_.push_back(box);
    });
    if (around_.empty()) return;
    const std::size_t end = surface_.sectionEnd(section);
    for (std::size_t first = section * Surface::kSection; first < end; first += kRunsAtOnce) {
      const std::size_t last = std::min(first + kRunsAtOnce, end);
      Box box = Box::empty();
      for (std::size_t run = first; run < last; ++run) box.add(surface_.runBox(run));
      if (!near_[1].takeMeeting({box, from_}, near_[0])) continue;
      for (std::size_t run = first; run < last; ++run) {
        if (near_[2].takeMeeting({surface_.runBox(run), from_}, near_[1])) pairsOfRun(run);
      }
    }
  }
  [[nodiscard]] const ClosePairs& found() const { return found_; }

 private:
  void pairsOfRun(std::size_t run) {
    const std::vector<std::uint32_t>& near = near_[2].items();
    const PolygonIndex begin = surface_.runBegin(run), end = surface_.runEnd(run);
    std::array<bool, Surface::kRun> isCandidate{};
    for (const std::uint32_t i : near) {
      if (around_[i] >= begin && around_[i] < end) isCandidate[around_[i] - begin] = true;
    }
    for (PolygonIndex p = begin; p < end; ++p) {
      const Box box = surface_.box(p);
      for (const std::uint32_t place : scratch_.findMeeting({box, from_}, near_[2])) {
        const PolygonIndex other = around_[near[place]];
        // Of two candidates, the higher one is found from the lower one.
        if (isCandidate[p - begin] && other < p) continue;
        if (!box.meets(boxes_[near[place]])) continue;
        if (search_.matters && !search_.matters(p, other)) continue;
        test(search_, {std::min(p, other), std::max(p, other)}, found_);
      }
    }
  }

  const Search& search_;
  const Surface& surface_;
  const base::Bvh& tree_;
  const std::vector<PolygonIndex>& candidates_;
  Vec3 from_{0.0};                    // the section's lower corner
  std::vector<PolygonIndex> around_;  // candidates that meet the section
  std::vector<Box> boxes_;            // theirs
  std::array<NearBoxes, 3> near_;     // places in these two, after each step
  NearBoxes scratch_;
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
