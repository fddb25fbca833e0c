#include "chunks/cut/move_to_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/collect.h"
#include "base/huge_pages.h"
#include "chunks/cut/pairs_at.h"
#include "chunks/cut/turned.h"

namespace tufa::chunks {
namespace {

// Which vertices are moved to planes.
struct Move {
  double distance;    ///< along the axis within which they are, steps of the lattice
  double turnCosine;  ///< unless a triangle turns by more than the angle of this cosine,
  double leastShare;  ///< or shrinks to less than this share
  bool makesChains;   ///< see PlaneMover::leaveChains()
};

// Those that are very near also where slivers turn: otherwise edges around them would be cut in
// places that single precision does not tell apart. Each distance is below the one before.
constexpr Move kMoves[] = {
    {kNearPlane, 0.9, 0.25, false}, {5e-4, 0.05, 0.02, false}, {2e-5, -2, 0, true}};

// The surface lies along a plane where all vertices of a triangle are this near to it, and its
// normal is within the angle of this cosine of the axis.
constexpr double kAlongPlane = 0.05, kAlongCosine = 0.95;
// Fewer vertices are not worth it: where vertices are moved far, less is left to reduction.
constexpr std::ptrdiff_t kFewFar = 64;

constexpr double kStays = std::numeric_limits<double>::infinity();

class PlaneMover {
 public:
  PlaneMover(const ChunkPlanes& planes, int axis, double flatDistance,
             const std::vector<Triangle>& triangles, std::vector<Vec3>& points, base::Job& job)
      : planes_(planes),
        axis_(axis),
        flatDistance_(std::max(flatDistance, kNearPlane)),
        triangles_(triangles),
        points_(points),
        job_(job) {}

  std::vector<MovedVertex> run() {
    near_ = base::collectIf(job_, points_.size(), [&](std::uint32_t v) {
      const double off = offPlane(v);
      return off > 0 && off < flatDistance_;
    });
    if (near_.empty()) return {};
    findTouched();
    findFlat();
    base::resizeLarge(target_, points_.size(), job_, kStays);
    base::resizeLarge(before_, points_.size(), job_, kStays);
    std::vector<double> first;
    for (const VertexIndex v : near_) first.push_back(points_[v][axis_]);
    for (const Move& move : kMoves) make(move);
    std::vector<MovedVertex> moved;
    for (std::size_t i = 0; i < near_.size(); ++i) {
      const double by = std::abs(points_[near_[i]][axis_] - first[i]);
      if (by > 0) moved.push_back({near_[i], by});
    }
    return moved;
  }

 private:
  // The triangles with vertices that may be moved.
  void findTouched() {
    std::vector<std::uint8_t> isNear(points_.size(), 0);
    for (const VertexIndex v : near_) isNear[v] = 1;
    touched_ = base::collectIf(job_, triangles_.size(), [&](std::uint32_t t) {
      const auto& v = triangles_[t].vertices;
      return (isNear[v[0]] | isNear[v[1]] | isNear[v[2]]) != 0;
    });
  }

  // The vertices where the surface lies along a plane, at its borders too.
  void findFlat() {
    base::resizeLarge(isFlat_, points_.size(), job_);
    if (flatDistance_ <= kNearPlane) return;
    for (const std::uint32_t t : touched_) {
      const auto& v = triangles_[t].vertices;
      if (std::max({offPlane(v[0]), offPlane(v[1]), offPlane(v[2])}) >= kAlongPlane) continue;
      const Vec3 normal = (points_[v[1]] - points_[v[0]]).cross(points_[v[2]] - points_[v[0]]);
      if (std::abs(normal[axis_]) < kAlongCosine * normal.length()) continue;
      for (const VertexIndex corner : v) isFlat_[corner] = 1;
    }
    const auto isFar = [&](VertexIndex v) { return isFlat_[v] != 0 && offPlane(v) >= kNearPlane; };
    if (std::count_if(near_.begin(), near_.end(), isFar) >= kFewFar) return;
    std::fill(isFlat_.begin(), isFlat_.end(), std::uint8_t{0});
  }

  [[nodiscard]] double offPlane(VertexIndex v) const {
    const double x = points_[v][axis_];
    return std::abs(planes_.nearest(axis_, x) - x);
  }

  void make(const Move& move) {
    for (const VertexIndex v : near_) {
      const double x = points_[v][axis_], plane = planes_.nearest(axis_, x);
      const bool isFar = isFlat_[v] != 0 && &move == kMoves;
      const double most = isFar ? flatDistance_ : move.distance;
      target_[v] = plane != x && std::abs(plane - x) < most ? plane : kStays;
    }
    if (!move.makesChains) leaveChains();
    for (bool isAny = true; isAny;) {
      isAny = false;
      for (const std::uint32_t t : touched_) {
        if (!turns(t, move)) continue;
        for (const VertexIndex v : triangles_[t].vertices) target_[v] = kStays;
        isAny = true;
      }
    }
    bool isAny = false;
    for (const VertexIndex v : near_) {
      before_[v] = kStays;
      if (target_[v] == kStays) continue;
      before_[v] = std::exchange(points_[v][axis_], target_[v]);
      isAny = true;
    }
    if (isAny) returnIntersecting();
  }

  // A vertex that was made on a plane of an axis before is on an edge of chunks once it is moved.
  // Where several in a row are and the surface leaves this plane beside them, this plane's curve
  // would run along the edge: ends of curves all of them, which stay at every LOD. They stay where
  // they are, and the curve runs through the vertices beside them.
  void leaveChains() {
    for (int other = 0; other < axis_; ++other) {
      std::vector<std::uint8_t> isInChain(points_.size(), 0), isBorder(points_.size(), 0);
      for (const std::uint32_t t : touched_) {
        for (const VertexIndex v : triangles_[t].vertices) {
          if (target_[v] == kStays || !isOn(other, v)) continue;
          for (const VertexIndex w : triangles_[t].vertices) {
            if (w == v) continue;
            const bool isBeside = points_[w][other] == points_[v][other];
            const bool willBeOn = target_[w] != kStays || isOn(axis_, w);
            if (isBeside && willBeOn) isInChain[v] = 1;
            if (!isBeside && !willBeOn) isBorder[v] = 1;
          }
        }
      }
      for (const VertexIndex v : near_) {
        if ((isInChain[v] & isBorder[v]) != 0) target_[v] = kStays;
      }
    }
  }

  [[nodiscard]] bool isOn(int axis, VertexIndex v) const {
    return points_[v][axis] == planes_.nearest(axis, points_[v][axis]);
  }

  // Whether a triangle would turn or shrink too much.
  [[nodiscard]] bool turns(std::uint32_t t, const Move& move) const {
    Vec3 before[3], after[3];
    bool isTouched = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const VertexIndex v = triangles_[t].vertices[i];
      before[i] = after[i] = points_[v];
      if (target_[v] != kStays) after[i][axis_] = target_[v], isTouched = true;
    }
    return isTouched && isTurned(before, after, move.turnCosine, move.leastShare);
  }

  // Puts vertices back whose move makes some of the triangles intersect others: where sheets nearly
  // touch, moves as small as these do. Not asked of triangles that lie in the plane now, but at
  // their border: flat faces have thousands, do not intersect each other, and are searched with all
  // that is new once the mesh is cut.
  void returnIntersecting() {
    std::vector<std::uint8_t> marks(points_.size(), 0);
    for (const std::uint32_t t : touched_) {
      const auto& corners = triangles_[t].vertices;
      const bool isInPlane = std::all_of(corners.begin(), corners.end(),
                                         [&](VertexIndex v) { return isOn(axis_, v); });
      for (const VertexIndex v : corners) {
        if (!isInPlane && before_[v] != kStays) marks[v] = 1;
      }
    }
    for (bool isAny = true; isAny;) {
      isAny = false;
      const std::vector<intersect::PolygonPair> pairs = findPairsAt(
          triangles_, points_, [&](VertexIndex v) { return points_[v]; }, marks, job_);
      std::fill(marks.begin(), marks.end(), std::uint8_t{0});  // now of those that are put back
      for (const intersect::PolygonPair& pair : pairs) {
        for (const std::uint32_t t : {pair.a, pair.b}) {
          for (const VertexIndex v : triangles_[t].vertices) {
            if (before_[v] == kStays || points_[v][axis_] == before_[v]) continue;
            points_[v][axis_] = before_[v];
            marks[v] = 1;
            isAny = true;
          }
        }
      }
    }
  }

  const ChunkPlanes& planes_;
  int axis_;
  double flatDistance_;
  const std::vector<Triangle>& triangles_;
  std::vector<Vec3>& points_;
  base::Job& job_;
  std::vector<VertexIndex> near_;  ///< that may be moved, rising
  std::vector<std::uint32_t> touched_;
  std::vector<std::uint8_t> isFlat_;  ///< of vertices
  // For each vertex, or kStays: where it goes in the move at hand, and where it was before.
  std::vector<double> target_, before_;
};

}  // namespace

std::vector<MovedVertex> moveToPlanes(const ChunkPlanes& planes, int axis, double flatDistance,
                                      const std::vector<Triangle>& triangles,
                                      std::vector<Vec3>& points, base::Job& job) {
  return PlaneMover(planes, axis, flatDistance, triangles, points, job).run();
}

}  // namespace tufa::chunks
