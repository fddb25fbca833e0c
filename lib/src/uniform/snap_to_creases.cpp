#include "uniform/snap_to_creases.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "base/huge_pages.h"
#include "uniform/acute.h"
#include "uniform/point_grid.h"
#include "uniform/quad_places.h"

namespace tufa::uniform {
namespace {

// The farthest a vertex may move, in voxels.
constexpr double kFarthest = 1.0;
// And onto an acute edge by kFarthestAcute, if the quad's corners on each of its sheets lie in one
// plane to so many voxels.
constexpr double kFlatCorner = 0.05;
// Two corners nearer than this, in voxels, are one.
constexpr double kSameCorner = 0.5;
// A snap may leave a defect in the next quad, and of snaps beside each other only one is made in a
// round; few places need more than two rounds. A round reaches two cells far.
constexpr int kRounds = 6;
// Snaps whose distances fall into one step of this, in voxels, are ordered by a hash. Ordered by
// distance alone, those along a straight crease would wait for each other in a long chain.
constexpr double kStep = 1.0 / 16;

struct Plane {
  Vec3 point;
  Vec3 normal;
};

struct Move {
  double distance = std::numeric_limits<double>::infinity();
  std::uint64_t order = 0;  // of two snaps beside each other the lower one is made
  std::size_t quad = 0;
  VertexIndex vertex = 0;
  Vec3 point;
  MeetingSheets sheets;
};

Normal toNormal(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

// The point of two planes nearest to `from`; none if they are nearly parallel.
std::optional<Vec3> onBoth(const Plane& a, const Plane& b, const Vec3& from) {
  const double cosine = a.normal.dot(b.normal);
  const double squared = 1 - cosine * cosine;
  if (squared < 0.05) return {};
  const double da = a.normal.dot(a.point - from), db = b.normal.dot(b.point - from);
  return from + a.normal * ((da - cosine * db) / squared) +
         b.normal * ((db - cosine * da) / squared);
}

std::optional<Vec3> onAll(const Plane& a, const Plane& b, const Plane& c) {
  const Vec3 bc = b.normal.cross(c.normal);
  const double volume = a.normal.dot(bc);
  if (std::abs(volume) < 0.1) return {};
  return (bc * a.normal.dot(a.point) + c.normal.cross(a.normal) * b.normal.dot(b.point) +
          a.normal.cross(b.normal) * c.normal.dot(c.point)) /
         volume;
}

// The lowest order of the moves of each vertex that has some. Moves are few beside vertices.
class LowestOrders {
 public:
  explicit LowestOrders(const std::vector<Move>& moves) {
    for (const Move& move : moves) orders_.emplace_back(move.vertex, move.order);
    std::sort(orders_.begin(), orders_.end());
  }
  // Above all orders if the vertex has none.
  [[nodiscard]] std::uint64_t of(VertexIndex vertex) const {
    const auto at =
        std::lower_bound(orders_.begin(), orders_.end(), std::pair(vertex, std::uint64_t{0}));
    return at != orders_.end() && at->first == vertex ? at->second
                                                      : std::numeric_limits<std::uint64_t>::max();
  }

 private:
  std::vector<std::pair<VertexIndex, std::uint64_t>> orders_;
};

class CreaseSnapper {
 public:
  CreaseSnapper(Mesh& mesh, VertexSheets& sheets, double voxelSize, const QuadsAt& quadsAt,
                const Admits& admits)
      : mesh_(mesh),
        sheets_(sheets),
        voxelSize_(voxelSize),
        quadsAt_(quadsAt),
        admits_(admits),
        corners_(kSameCorner * voxelSize) {}

  std::size_t run(base::Job& job) {
    collectCorners();
    base::resizeLarge(isTouched_, mesh_.positions.size(), job);
    std::size_t moved = 0;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<Move> moves = round == 0 ? findMoves(job) : findMovesAgain(job);
      dropContested(moves);
      std::size_t inRound = 0;
      for (const Move& move : moves) {
        // Two quads that share no vertex may have found the same corner.
        if (move.sheets.count > 2 && isCorner(move.point)) continue;
        apply(move);
        ++inRound;
      }
      moved += inRound;
      if (moves.empty()) break;
    }
    return moved;
  }

 private:
  // Corners that have a vertex. No second one snaps to them.
  void collectCorners() {
    for (std::size_t v = 0; v < mesh_.positions.size(); ++v) {
      const auto vertex = static_cast<VertexIndex>(v);
      if (sheets_.kind(vertex) != VertexSheets::Kind::Meeting) continue;
      if (sheets_.sheets(mesh_, vertex).count > 2) corners_.add(pointOf(vertex));
    }
  }

  [[nodiscard]] Vec3 pointOf(VertexIndex vertex) const {
    const Position& p = mesh_.positions[vertex];
    return {p.x, p.y, p.z};
  }

  [[nodiscard]] bool isCorner(const Vec3& point) const { return corners_.hasNear(point); }

  // Finds the snap of each quad that needs one.
  std::vector<Move> findMoves(base::Job& job) const {
    return findMovesAmong(mesh_.quads.size(), job, [&](std::size_t i, std::vector<Move>& found) {
      if (!isNearCrease(sheets_, mesh_.quads[i])) return;
      if (auto move = moveFor(i)) found.push_back(*move);
    });
  }

  // After the first round only quads with a vertex moved in the last one, or whose snap had to
  // wait, can need one.
  std::vector<Move> findMovesAgain(base::Job& job) {
    std::sort(touched_.begin(), touched_.end());
    const std::vector<std::uint32_t> quads = quadsAt_(touched_, isTouched_);
    for (const VertexIndex vertex : touched_) isTouched_[vertex] = 0;
    touched_.clear();
    return findMovesAmong(quads.size(), job, [&](std::size_t i, std::vector<Move>& found) {
      if (auto move = moveFor(quads[i])) found.push_back(*move);
    });
  }

  template <class Find>
  static std::vector<Move> findMovesAmong(std::size_t count, base::Job& job, const Find& find) {
    std::vector<Move> moves;
    std::mutex mutex;
    job.forRanges(count, [&](std::size_t begin, std::size_t end) {
      std::vector<Move> found;
      for (std::size_t i = begin; i < end; ++i) find(i, found);
      const std::scoped_lock lock(mutex);
      moves.insert(moves.end(), found.begin(), found.end());
    });
    return moves;
  }

  void touch(VertexIndex vertex) {
    if (std::exchange(isTouched_[vertex], std::uint8_t{1}) == 0) touched_.push_back(vertex);
  }

  // Keeps the snaps that wait for none: no lower one moves a vertex of the same quad. So the kept
  // ones are independent, and which they are depends on what is near alone.
  void dropContested(std::vector<Move>& moves) {
    const LowestOrders lowest(moves);
    std::vector<Move> kept;
    for (const Move& move : moves) {
      const auto& v = mesh_.quads[move.quad].vertices;
      const bool waits = std::any_of(
          v.begin(), v.end(), [&](VertexIndex vertex) { return lowest.of(vertex) < move.order; });
      if (waits) {
        touch(v[0]);
      } else {
        kept.push_back(move);
      }
    }
    std::sort(kept.begin(), kept.end(),
              [](const Move& a, const Move& b) { return a.order < b.order; });
    moves = std::move(kept);
  }

  // The order of a snap: its distance in steps, then a hash of the positions of the quad's corners.
  // Not of their indices: positions are the same wherever the mesh begins.
  [[nodiscard]] std::uint64_t orderOf(const Move& move) const {
    std::uint64_t hash = 0;
    for (const VertexIndex vertex : mesh_.quads[move.quad].vertices) {
      const Position& p = mesh_.positions[vertex];
      for (const double x : {p.x, p.y, p.z}) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15U;
        hash ^= hash >> 29;
      }
    }
    constexpr int kHashBits = 56;
    const auto step = static_cast<std::uint64_t>(move.distance / (kStep * voxelSize_));
    return (step << kHashBits) | (hash >> (64 - kHashBits));
  }

  // The shortest snap that lets a quad be split along its crease; none if it needs none or none is
  // short enough. Creases are tried only if no corner is near enough.
  [[nodiscard]] std::optional<Move> moveFor(std::size_t quad) const {
    const Quad& q = mesh_.quads[quad];
    if (QuadSheets::isOneSheet(mesh_, sheets_, q)) return {};
    const QuadSheets around(mesh_, sheets_, q);
    if (around.fits(false) || around.fits(true)) return {};
    Move best;
    for (int corner = 0; corner < 4; ++corner) {
      if (!around.known(corner)) continue;
      proposeCorners(q, around, corner, best);
    }
    if (!std::isfinite(best.distance)) {
      for (int corner = 0; corner < 4; ++corner) {
        if (around.known(corner)) proposeCreases(q, around, corner, best);
      }
    }
    if (!std::isfinite(best.distance)) return {};
    best.quad = quad;
    best.order = orderOf(best);
    return best;
  }

  // Whether a place beyond kFarthest is believed: on an acute edge of flat sheets, and admitted by
  // the samples.
  [[nodiscard]] bool isFarEdge(const Quad& quad, const QuadSheets& around, const Vec3& point,
                               double distance, std::initializer_list<Plane> planes) const {
    if (!(distance < kFarthestAcute * voxelSize_)) return false;
    const bool isSharp = std::any_of(planes.begin(), planes.end(), [&](const Plane& a) {
      return std::any_of(planes.begin(), planes.end(),
                         [&](const Plane& b) { return isAcute(a.normal.dot(b.normal)); });
    });
    return isSharp && isFlat(quad, around) && admits_(point);
  }

  // Whether all corners of a quad on one of its sheets lie in one plane.
  [[nodiscard]] bool isFlat(const Quad& quad, const QuadSheets& around) const {
    for (int side = 0; side < around.count(); ++side) {
      std::optional<Vec3> first;
      for (int corner = 0; corner < 4; ++corner) {
        if (!around.known(corner) || !around.lies(corner, side)) continue;
        const Vec3 point = pointOf(quad.vertices[corner]);
        if (!first) first = point;
        if (std::abs(around.normal(side).dot(point - *first)) > kFlatCorner * voxelSize_)
          return false;
      }
    }
    return true;
  }

  // The plane of a sheet, through vertex `corner` itself if that lies on it, else through the next
  // vertex that does, with that vertex's own normal of the sheet.
  [[nodiscard]] std::optional<Plane> planeOf(const Quad& quad, const QuadSheets& around, int side,
                                             int corner) const {
    for (int i = 0; i < 4; ++i) {
      const int candidate = (corner + i) % 4;
      if (!around.known(candidate) || !around.lies(candidate, side)) continue;
      const MeetingSheets own = sheets_.sheets(mesh_, quad.vertices[candidate]);
      Plane plane{pointOf(quad.vertices[candidate]), around.normal(side)};
      double nearest = -1;
      for (int k = 0; k < own.count; ++k) {
        const Vec3 normal(own.normals[k].x, own.normals[k].y, own.normals[k].z);
        if (normal.dot(around.normal(side)) <= nearest) continue;
        nearest = normal.dot(around.normal(side));
        plane.normal = normal;
      }
      return plane;
    }
    return {};
  }

  // The planes of all sheets as far as they are known, preferably through one corner.
  using Planes = std::array<std::optional<Plane>, QuadSheets::kMost>;
  [[nodiscard]] Planes planesOf(const Quad& quad, const QuadSheets& around, int corner) const {
    Planes planes;
    for (int side = 0; side < around.count(); ++side) {
      planes[side] = planeOf(quad, around, side, corner);
    }
    return planes;
  }

  // A vertex on one sheet may snap to the crease of that sheet and another one of the quad.
  // Vertices that are on creases already stay.
  void proposeCreases(const Quad& quad, const QuadSheets& around, int corner, Move& best) const {
    const VertexIndex vertex = quad.vertices[corner];
    if (sheets_.isSharp(vertex)) return;
    const Vec3 from = pointOf(vertex);
    const Planes planes = planesOf(quad, around, corner);
    for (int a = 0; a < around.count(); ++a) {
      if (!around.lies(corner, a) || !planes[a]) continue;
      for (int b = 0; b < around.count(); ++b) {
        if (b == a || !planes[b]) continue;
        const auto point = onBoth(*planes[a], *planes[b], from);
        if (point) consider(quad, around, vertex, from, *point, {*planes[a], *planes[b]}, best);
      }
    }
  }

  // A vertex on one of three sheets may snap to their corner, unless a vertex is there already.
  void proposeCorners(const Quad& quad, const QuadSheets& around, int corner, Move& best) const {
    const VertexIndex vertex = quad.vertices[corner];
    if (around.count() < 3 || sheets_.sheets(mesh_, vertex).count > 2) return;
    const Vec3 from = pointOf(vertex);
    const Planes planes = planesOf(quad, around, corner);
    for (int a = 0; a < around.count(); ++a) {
      for (int b = a + 1; b < around.count(); ++b) {
        for (int c = b + 1; c < around.count(); ++c) {
          if (!around.lies(corner, a) && !around.lies(corner, b) && !around.lies(corner, c))
            continue;
          if (!planes[a] || !planes[b] || !planes[c]) continue;
          const auto point = onAll(*planes[a], *planes[b], *planes[c]);
          if (!point || !((*point - from).length() < best.distance) || isCorner(*point)) continue;
          consider(quad, around, vertex, from, *point, {*planes[a], *planes[b], *planes[c]}, best);
        }
      }
    }
  }

  void consider(const Quad& quad, const QuadSheets& around, VertexIndex vertex, const Vec3& from,
                const Vec3& point, std::initializer_list<Plane> planes, Move& best) const {
    const double distance = (point - from).length();
    if (distance >= best.distance) return;
    if (distance >= kFarthest * voxelSize_ && !isFarEdge(quad, around, point, distance, planes)) {
      return;
    }
    best.distance = distance;
    best.vertex = vertex;
    best.point = point;
    best.sheets = {};
    for (const Plane& plane : planes) {
      best.sheets.normals[best.sheets.count++] = toNormal(plane.normal);
    }
  }

  void apply(const Move& move) {
    touch(move.vertex);
    mesh_.positions[move.vertex] = {move.point[0], move.point[1], move.point[2]};
    Vec3 sum(0);
    for (int i = 0; i < move.sheets.count; ++i) {
      const Normal& n = move.sheets.normals[i];
      sum += Vec3(n);
    }
    mesh_.normals[move.vertex] = toNormal(sum.unitOrX());
    sheets_.setMeeting(move.vertex, move.sheets);
    sheets_.setOutOfCell(move.vertex);
    if (move.sheets.count > 2) corners_.add(move.point);
  }

  Mesh& mesh_;
  VertexSheets& sheets_;
  double voxelSize_;
  const QuadsAt& quadsAt_;
  const Admits& admits_;
  PointGrid corners_;
  std::vector<VertexIndex> touched_;     // around which the next round looks
  std::vector<std::uint8_t> isTouched_;  // of each vertex
};

}  // namespace

std::size_t snapToCreases(Mesh& mesh, VertexSheets& sheets, double voxelSize,
                          const QuadsAt& quadsAt, const Admits& admits, base::Job& job) {
  return CreaseSnapper(mesh, sheets, voxelSize, quadsAt, admits).run(job);
}

}  // namespace tufa::uniform
