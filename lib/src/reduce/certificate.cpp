#include "reduce/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "base/sort_unique.h"
#include "reduce/halving.h"
#include "reduce/measured.h"
#include "reduce/overlay_path.h"
#include "reduce/overlay_surface.h"
#include "reduce/uncovered.h"
#include "reduce/way_back.h"

namespace tufa::reduce {
namespace {

// Bounds the way from the reference to the surface.
class WayForth {
 public:
  WayForth(const Surface& s, const ReferenceMesh& reference, const Limits& limits,
           RegionMaxima& regions, base::Job& job)
      : s_(s),
        reference_(reference),
        limits_(limits),
        regions_(regions),
        owner_(s.owner),
        corners_(s.position.size(), s.triangles, job),
        opposite_(oppositeCorners(s.triangles, corners_, job)),
        overlay_{s, opposite_} {}

  void vertices(std::size_t begin, std::size_t end, Measured& measured) const {
    for (std::size_t r = begin; r < end; ++r) {
      if (owner_[r] == kNone) continue;
      const float limit = limits_.atVertex(static_cast<Index>(r));
      const float d = distanceWithin(limit, reference_.positions()[r], owner_[r]);
      measured.sum += static_cast<double>(d);
      regions_.see(owner_[r], d);
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
    const OwnedFace face = ownedFace(reference_, owner_, f);
    const std::vector<Index> around = trianglesAround(s_.triangles, corners_, face.owners);
    for (std::size_t i = 0; i < 3; ++i) {
      const Index r = face.vertices[i];
      if (reference_.isAtBorder(r)) continue;
      for (const auto& [d, t] : nearest(face.corners[i], limits_.ofFace(f), around)) {
        owner_[r] = t;
        Measured there;
        if (t != face.owners[i] && passes(f, there) &&
            reference_.allAround(r, [&](Index g) { return passes(g, there); })) {
          regions_.see(t, d);
          measured.see(std::max(d, there.largest), f, limits_.ofFace(f));
          return true;
        }
      }
      owner_[r] = face.owners[i];
    }
    return false;
  }

  // The way from a face to the triangles around its owners, by halving.
  void halve(Index f, Measured& measured) const {
    const OwnedFace face = ownedFace(reference_, owner_, f);
    const std::vector<Index> around = trianglesAround(s_.triangles, corners_, face.owners);
    const auto toTriangle = [&](Vec3f q, Index t) { return distance(q, t); };
    const float limit = limits_.ofFace(f);
    const float way =
        Halving(toTriangle, Sphere{{}, kEverywhere}, limit).bound(face.corners, around);
    regions_.seeAround(face.owners, way);
    measured.see(way, f, limit);
  }

  // The triangles that the ways along the edges of halved faces pass, but for edges between two of
  // them: the border of what all other faces go to. `halved`: sorted.
  [[nodiscard]] std::vector<Gap> gapsAt(const std::vector<Index>& halved) const {
    std::vector<Gap> gaps;
    for (const Index f : halved) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Index across = reference_.faceAcross(f, i);
        if (across == kNone || !std::binary_search(halved.begin(), halved.end(), across)) {
          addWay(f, i, across == kNone ? f : across, gaps);
        }
      }
    }
    return gaps;
  }

  [[nodiscard]] const CornersOfVertices& corners() const { return corners_; }
  [[nodiscard]] std::span<const Index> owner() const { return owner_; }
  [[nodiscard]] Uncovered uncovered(const std::vector<Index>& halved, const std::vector<Gap>& gaps,
                                    base::Job& job) const {
    return findUncovered({overlay_, corners_, reference_, owner_, limits_.most()}, halved, gaps,
                         job);
  }

 private:
  // The nearest of some triangles within a limit, with their distances.
  [[nodiscard]] std::vector<std::pair<float, Index>> nearest(
      Vec3f p, float limit, const std::vector<Index>& triangles) const {
    constexpr std::size_t kMost = 6;
    std::vector<std::pair<float, Index>> found;
    for (const Index t : triangles) {
      const float d = distanceWithin(limit, p, t);
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
    const OwnedFace face = ownedFace(reference_, owner_, f);
    const float limit = limits_.ofFace(f);
    const float way = regions_.isEmpty() ? std::sqrt(overlayBound2(overlay_, face, limit * limit))
                                         : wayOverRegions(face, limit);
    if (!(way <= limit)) return false;
    measured.see(way, f, limit);
    return true;
  }

  // The way of a face, which the regions of all triangles that it lies over see.
  float wayOverRegions(const OwnedFace& face, float limit) const {
    std::array<OverlayPath, 3> paths;
    std::size_t found = 0;
    std::vector<Index> turned;
    const auto findPath = [&](std::size_t a, std::size_t b, OverlayPath& path) {
      const bool isFound = findOverlayPath(overlay_, {face.corners[a], face.corners[b]},
                                           face.owners[a], face.owners[b], limit * limit, path);
      paths[found++] = path;
      return isFound;
    };
    const auto onTurn = [&](const OverlayTurn& turn) { turned.push_back(turn.vertex); };
    const float way = std::sqrt(overlayBound2(overlay_, face, limit * limit, findPath, onTurn));
    if (!(way <= limit)) return way;
    regions_.seeAround(face.owners, way);
    for (const OverlayPath& path : paths) {
      for (int k = 0; k < path.count; ++k) {
        regions_.see(path.triangles[static_cast<std::size_t>(k)], way);
      }
    }
    for (const Index v : turned) regions_.seeVertex(v, way);
    return way;
  }

  [[nodiscard]] float distance(Vec3f p, Index t) const {
    return std::sqrt(
        squaredDistanceToTriangle(p, s_.corner(t, 0), s_.corner(t, 1), s_.corner(t, 2)));
  }

  // What seems too far is measured again in double precision: it may be near a sliver.
  [[nodiscard]] float distanceWithin(float limit, Vec3f p, Index t) const {
    const float d = distance(p, t);
    if (d <= limit) return d;
    return static_cast<float>(std::sqrt(
        exactSquaredDistanceToTriangle(p, s_.corner(t, 0), s_.corner(t, 1), s_.corner(t, 2))));
  }

  // The way along a face's edge from its corner i on, as overlayBound2() has it for the face
  // `other` at that edge. At borders there may be none: then what is known of it, its ends.
  void addWay(Index f, std::size_t i, Index other, std::vector<Gap>& gaps) const {
    const OwnedFace face = ownedFace(reference_, owner_, f);
    const std::size_t j = (i + 1) % 3;
    const bool isTurned = face.vertices[i] > face.vertices[j];
    const std::size_t a = isTurned ? j : i, b = isTurned ? i : j;
    const float limit = limits_.ofFace(other);
    OverlayPath path;
    if (!findOverlayPath(overlay_, {face.corners[a], face.corners[b]}, face.owners[a],
                         face.owners[b], limit * limit, path)) {
      path.count = 2;
      path.triangles[0] = face.owners[a], path.triangles[1] = face.owners[b];
    }
    for (int k = 0; k < path.count; ++k) {
      gaps.push_back({path.triangles[static_cast<std::size_t>(k)], f});
    }
  }

  const Surface& s_;
  const ReferenceMesh& reference_;
  const Limits& limits_;
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

// The way back from gaps. Sorts them.
void measureGaps(const WayForth& forth, const Surface& s, const ReferenceMesh& reference,
                 const Limits& limits, RegionMaxima& regions, std::vector<Gap>& gaps,
                 std::vector<Measured>& parts, base::Job& job) {
  const WayBack back(s, reference, forth.corners(), forth.owner(), gaps, limits, regions);
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
    back.fromGaps({gaps.data() + first[i], gaps.data() + first[i + 1]}, part);
  });
}

}  // namespace

Certificate certify(const Surface& s, const ReferenceMesh& reference, float expected,
                    base::Job& job) {
  RegionMaxima regions(s);
  const Limits limits(reference, expected);
  WayForth forth(s, reference, limits, regions, job);
  const std::size_t vertices = s.owner.size(), faces = reference.faceCount();
  const std::size_t a = (vertices + base::kGrain - 1) / base::kGrain,
                    b = (faces + base::kGrain - 1) / base::kGrain;
  std::vector<Measured> parts(a + b);  // their limits, and so the sums, do not depend on threads
  job.forRanges(a + b, 1, [&](std::size_t firstPart, std::size_t endPart) {
    for (std::size_t i = firstPart; i < endPart; ++i) {
      const std::size_t begin = (i < a ? i : i - a) * base::kGrain;
      if (i < a) {
        forth.vertices(begin, std::min(vertices, begin + base::kGrain), parts[i]);
      } else {
        forth.faces(begin, std::min(faces, begin + base::kGrain), parts[i]);
      }
    }
  });
  Certificate all;
  std::vector<Index> halved;
  Measured last;
  for (const Measured& p : parts) {
    for (const Index f : p.open) {
      job.checkCancelled(0, 1);
      if (forth.findOwners(f, last)) continue;
      forth.halve(f, last);
      halved.push_back(f);
    }
  }
  parts.push_back(last);
  all.halved = static_cast<Index>(halved.size());
  std::sort(halved.begin(), halved.end());
  std::vector<Gap> gaps = forth.gapsAt(halved);  // once all owners are found
  if (!gaps.empty()) measureGaps(forth, s, reference, limits, regions, gaps, parts, job);
  if (const Uncovered uncovered = forth.uncovered(halved, gaps, job);
      !uncovered.triangles.empty()) {
    const FacesNear near(reference, uncovered.faces, job);
    constexpr std::size_t kTogether = 64;
    measureEach(uncovered.triangles.size(), kTogether, parts, job,
                [&](std::size_t i, Measured& part) {
                  measureWayBack(s, reference, limits, regions, uncovered.triangles[i], near, part);
                });
  }
  double sum = 0;
  for (const Measured& p : parts) {
    if (p.largest > all.largest) all.largest = p.largest, all.worst = p.worst;
    all.mostOver = std::max(all.mostOver, p.mostOver);
    sum += p.sum;
    all.beyond.insert(all.beyond.end(), p.beyond.begin(), p.beyond.end());
  }
  base::sortUnique(all.beyond);
  all.ofRegion = regions.take(forth.corners());
  all.mean = vertices == 0 ? 0 : static_cast<float>(sum / static_cast<double>(vertices));
  return all;
}

}  // namespace tufa::reduce
