#include <algorithm>
#include <array>
#include <mutex>

#include "intersect/surface.h"
#include "intersect/triangle_pair.h"

namespace tufa::intersect {

using base::Box;

namespace {

// Whether a plane certainly separates two polygons but for what they share; a quick answer for most
// that share two vertices or less. Quads need not be plane: their hulls are separated.
bool areParted(std::span<const Position> positions, Corners a, Corners b) {
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
  if (shared == 2) return arePartedAlong(common[0], common[1], ownA, ownB);
  return arePartedAt(shared == 1 ? common[0] : positions[a[0]], ownA, ownB, shared == 1);
}

}  // namespace

bool intersectElsewhere(std::span<const Position> positions, Corners a, Corners b, bool same) {
  std::array<Triangle, 2> ta, tb;
  const int countA = trianglesOf(a, ta), countB = trianglesOf(b, tb);
  if (same) return countA == 2 && intersectElsewhere(positions, ta[0], ta[1]);
  if (areParted(positions, a, b)) return false;
  for (int i = 0; i < countA; ++i) {
    for (int j = 0; j < countB; ++j) {
      if (intersectElsewhere(positions, ta[i], tb[j])) return true;
    }
  }
  return false;
}

namespace {

struct Candidate {
  PolygonIndex polygon;
  Box box;
};

// Polygons of a run that are compared with the candidates near them at once.
constexpr PolygonIndex kGroup = 4;

using Matters = std::function<bool(PolygonIndex, PolygonIndex)>;

// The pairs of the polygons of one run with the candidates near it. Boxes are compared in three
// steps: run, group, polygon; so a candidate is compared with few polygons of a run that it does
// not touch.
void pairsOfRun(const Surface& surface, std::size_t run, const std::vector<Candidate>& near,
                const Matters& matters, std::vector<PolygonPair>& pairs) {
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
        if (matters && !matters(p, other.polygon)) continue;
        if (intersectElsewhere(surface.mesh().positions, surface.corners(p),
                               surface.corners(other.polygon), p == other.polygon)) {
          pairs.push_back({std::min(p, other.polygon), std::max(p, other.polygon)});
        }
      }
    }
  }
}

}  // namespace

std::vector<PolygonPair> findPairs(const Surface& surface,
                                   const std::vector<PolygonIndex>& candidates, base::Job& job,
                                   const std::function<bool(PolygonIndex, PolygonIndex)>& matters) {
  std::vector<Box> boxes(candidates.size());
  job.forRanges(candidates.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) boxes[i] = surface.box(candidates[i]);
  });
  // The tree is over the candidates, which are few; runs of all polygons are looked up in it.
  // Sorting at the end makes the result independent of the threads.
  const base::Bvh tree(std::move(boxes), job);
  std::vector<PolygonPair> pairs;
  std::mutex mutex;
  job.forRanges(surface.runCount(), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<Candidate> near;
    std::vector<PolygonPair> found;
    for (std::size_t run = begin; run < end; ++run) {
      near.clear();
      tree.itemsMeeting(surface.runBox(run), [&](std::uint32_t i, const Box& box) {
        near.push_back({candidates[i], box});
      });
      if (!near.empty()) pairsOfRun(surface, run, near, matters, found);
    }
    const std::scoped_lock lock(mutex);
    pairs.insert(pairs.end(), found.begin(), found.end());
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace tufa::intersect
