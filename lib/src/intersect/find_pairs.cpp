#include <algorithm>
#include <array>
#include <functional>
#include <mutex>
#include <utility>

#include "base/parallel.h"
#include "intersect/surface.h"
#include "intersect/triangle_pair.h"

namespace tufa::intersect {

using base::Box;

namespace {

// Whether a plane certainly separates two polygons but for what they share, even if each vertex
// moves by half of `margin`; a quick answer for most that share two vertices or less. Quads need
// not be plane: their hulls are separated.
bool areParted(std::span<const Position> positions, Corners a, Corners b, double margin) {
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
  if (shared == 2) return arePartedAlong(common[0], common[1], ownA, ownB, margin);
  return arePartedAt(shared == 1 ? common[0] : positions[a[0]], ownA, ownB, shared == 1, margin);
}

// The same for the two triangles of a quad.
bool areHalvesParted(std::span<const Position> positions, Corners v, double margin) {
  if (v.size() != 4) return true;
  const Position& a = positions[v[1]];
  const Position& b = positions[v[3]];
  return arePartedAlong(positions[v[0]], positions[v[2]], {&a, 1}, {&b, 1}, margin);
}

}  // namespace

bool intersectElsewhere(std::span<const Position> positions, Corners a, Corners b, bool same) {
  std::array<Triangle, 2> ta, tb;
  const int countA = trianglesOf(a, ta), countB = trianglesOf(b, tb);
  if (same) return countA == 2 && intersectElsewhere(positions, ta[0], ta[1]);
  if (areParted(positions, a, b, 0)) return false;
  for (int i = 0; i < countA; ++i) {
    for (int j = 0; j < countB; ++j) {
      if (intersectElsewhere(positions, ta[i], tb[j])) return true;
    }
  }
  return false;
}

std::vector<PolygonPair> intersectingAmong(const std::vector<PolygonPair>& pairs, const Mesh& mesh,
                                           std::span<const Position> positions) {
  std::vector<PolygonPair> found;
  for (const PolygonPair& pair : pairs) {
    if (intersectElsewhere(positions, base::cornersOf(mesh, pair.a), base::cornersOf(mesh, pair.b),
                           pair.a == pair.b)) {
      found.push_back(pair);
    }
  }
  return found;
}

namespace {

struct Candidate {
  PolygonIndex polygon;
  Box box;
};

// Polygons of a run that are compared with the candidates near them at once.
constexpr PolygonIndex kGroup = 4;

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
  const bool parted = same ? areHalvesParted(positions, a, search.margin)
                           : areParted(positions, a, b, search.margin);
  if (parted) return;
  if (search.keepsClose) found.close.push_back(pair);
  if (intersectElsewhere(positions, a, b, same)) found.intersecting.push_back(pair);
}

// The pairs of the polygons of one run with the candidates near it. Boxes are compared in three
// steps: run, group, polygon; so a candidate is compared with few polygons of a run that it does
// not touch.
void pairsOfRun(const Search& search, std::size_t run, const std::vector<Candidate>& near,
                ClosePairs& found) {
  const Surface& surface = search.surface;
  const PolygonIndex begin = surface.runBegin(run), end = surface.runEnd(run);
  std::array<bool, Surface::kRun> isCandidate{};
  for (const Candidate& candidate : near) {
    if (candidate.polygon >= begin && candidate.polygon < end)
      isCandidate[candidate.polygon - begin] = true;
  }
  std::vector<Candidate> nearer;
  for (PolygonIndex group = begin; group < end; group += kGroup) {
    const PolygonIndex groupEnd = std::min(group + kGroup, end);
    std::array<Box, kGroup> boxes;
    Box all = Box::empty();
    for (PolygonIndex p = group; p < groupEnd; ++p) {
      boxes[p - group] = surface.box(p);
      all.add(boxes[p - group]);
    }
    nearer.clear();
    for (const Candidate& candidate : near) {
      if (all.meets(candidate.box)) nearer.push_back(candidate);
    }
    for (PolygonIndex p = group; p < groupEnd; ++p) {
      for (const Candidate& other : nearer) {
        // Of two candidates, the higher one is found from the lower one.
        if (!boxes[p - group].meets(other.box) || (isCandidate[p - begin] && other.polygon < p)) {
          continue;
        }
        if (search.matters && !search.matters(p, other.polygon)) continue;
        test(search, {std::min(p, other.polygon), std::max(p, other.polygon)}, found);
      }
    }
  }
}

}  // namespace

namespace {

ClosePairs find(const Search& search, const std::vector<PolygonIndex>& candidates, base::Job& job) {
  const Surface& surface = search.surface;
  const double margin = search.margin;
  std::vector<Box> boxes(candidates.size());
  job.forRanges(candidates.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      boxes[i] = surface.box(candidates[i]);
      boxes[i].lower -= Vec3(margin);
      boxes[i].upper += Vec3(margin);
    }
  });
  // The tree is over the candidates, which are few; sections of all polygons are looked up in it.
  // Sorting at the end makes the result independent of the threads.
  const base::Bvh tree(std::move(boxes), job);
  ClosePairs all;
  std::mutex mutex;
  job.forRanges(surface.sectionCount(), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<Candidate> around, near;
    ClosePairs found;
    for (std::size_t section = begin; section < end; ++section) {
      around.clear();
      tree.itemsMeeting(surface.sectionBox(section), [&](std::uint32_t i, const Box& box) {
        around.push_back({candidates[i], box});
      });
      if (around.empty()) continue;
      for (std::size_t run = section * Surface::kSection; run < surface.sectionEnd(section);
           ++run) {
        near.clear();
        for (const Candidate& candidate : around) {
          if (candidate.box.meets(surface.runBox(run))) near.push_back(candidate);
        }
        if (!near.empty()) pairsOfRun(search, run, near, found);
      }
    }
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
