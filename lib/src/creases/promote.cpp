#include "creases/promote.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

namespace tufa::creases {
namespace {

using openvdb::Vec3d;

// Sides whose normals differ by less than this (18 degrees) are one.
constexpr double kSameSide = 0.95;
// The farthest a vertex may move, in voxels.
constexpr double kFarthest = 1.0;

struct Plane {
  Vec3d point;
  Vec3d normal;
};

// `mover` goes to where its side meets that of `other`.
struct Move {
  VertexIndex mover;
  VertexIndex other;
  friend auto operator<=>(const Move&, const Move&) = default;
};

class Promoter {
 public:
  Promoter(Mesh& mesh, SideCounts& sides, double voxelSize)
      : mesh_(mesh), sides_(sides), voxelSize_(voxelSize) {}

  std::size_t run(base::Job& job) {
    std::vector<Move> moves = findMoves(job);
    std::sort(moves.begin(), moves.end());
    moves.erase(std::unique(moves.begin(), moves.end()), moves.end());
    // All targets first: they depend on where the others were.
    std::vector<Target> targets;
    for (std::size_t i = 0; i < moves.size();) {
      std::size_t end = i;
      while (end < moves.size() && moves[end].mover == moves[i].mover) ++end;
      if (const auto target = targetOf(moves.data() + i, end - i)) targets.push_back(*target);
      i = end;
    }
    for (const Target& target : targets) {
      mesh_.positions[target.vertex] = {target.point[0], target.point[1], target.point[2]};
      mesh_.normals[target.vertex] = {static_cast<float>(target.normal[0]),
                                      static_cast<float>(target.normal[1]),
                                      static_cast<float>(target.normal[2])};
      sides_[target.vertex] = target.sides;
    }
    return targets.size();
  }

 private:
  struct Target {
    VertexIndex vertex;
    Vec3d point;
    Vec3d normal;
    std::uint8_t sides;
  };

  [[nodiscard]] Plane planeOf(VertexIndex v) const {
    const Position& p = mesh_.positions[v];
    const Normal& n = mesh_.normals[v];
    return {{p.x, p.y, p.z}, {n.x, n.y, n.z}};
  }

  std::vector<Move> findMoves(base::Job& job) const {
    std::vector<Move> moves;
    std::mutex mutex;
    job.forRanges(mesh_.quads.size(), 4096, [&](std::size_t begin, std::size_t end) {
      std::vector<Move> found;
      for (std::size_t q = begin; q < end; ++q) {
        const auto& v = mesh_.quads[q].vertices;
        if ((sides_[v[0]] | sides_[v[1]] | sides_[v[2]] | sides_[v[3]]) == 0) continue;
        for (int i = 0; i < 4; ++i) {
          if (const auto move = moveFor(v[i], v[(i + 1) % 4])) found.push_back(*move);
        }
      }
      const std::scoped_lock lock(mutex);
      moves.insert(moves.end(), found.begin(), found.end());
    });
    return moves;
  }

  // The same answer whichever way round the edge is given.
  [[nodiscard]] std::optional<Move> moveFor(VertexIndex a, VertexIndex b) const {
    if (a > b) std::swap(a, b);
    if (sides_[a] > 1 || sides_[b] > 1 || (sides_[a] | sides_[b]) == 0) return {};
    const Plane pa = planeOf(a), pb = planeOf(b);
    if (pa.normal.dot(pb.normal) > kSameSide) return {};
    const auto toA = onBoth(pa, pb, pa.point), toB = onBoth(pa, pb, pb.point);
    if (!toA || !toB) return {};
    const double da = (*toA - pa.point).length(), db = (*toB - pb.point).length();
    if (std::min(da, db) > kFarthest * voxelSize_) return {};
    return da <= db ? Move{a, b} : Move{b, a};
  }

  // The point of two planes nearest to `from`; none if they are nearly parallel.
  static std::optional<Vec3d> onBoth(const Plane& a, const Plane& b, const Vec3d& from) {
    const double cosine = a.normal.dot(b.normal);
    const double squared = 1 - cosine * cosine;
    if (squared < 0.05) return {};
    const double da = a.normal.dot(a.point - from), db = b.normal.dot(b.point - from);
    return from + a.normal * ((da - cosine * db) / squared) +
           b.normal * ((db - cosine * da) / squared);
  }

  static std::optional<Vec3d> onAll(const Plane& a, const Plane& b, const Plane& c) {
    const Vec3d bc = b.normal.cross(c.normal);
    const double volume = a.normal.dot(bc);
    if (std::abs(volume) < 0.1) return {};
    return (bc * a.normal.dot(a.point) + c.normal.cross(a.normal) * b.normal.dot(b.point) +
            a.normal.cross(b.normal) * c.normal.dot(c.point)) /
           volume;
  }

  [[nodiscard]] std::optional<Target> targetOf(const Move* moves, std::size_t count) const {
    const VertexIndex vertex = moves[0].mover;
    const Plane own = planeOf(vertex);
    const Plane first = planeOf(moves[0].other);
    const auto crease = onBoth(own, first, own.point);
    if (!crease) return {};
    for (std::size_t i = 1; i < count; ++i) {
      const Plane second = planeOf(moves[i].other);
      const auto corner = onAll(own, first, second);
      if (!corner || (*corner - own.point).length() > kFarthest * voxelSize_) continue;
      return Target{vertex, *corner, (own.normal + first.normal + second.normal).unitSafe(), 3};
    }
    return Target{vertex, *crease, (own.normal + first.normal).unitSafe(), 2};
  }

  Mesh& mesh_;
  SideCounts& sides_;
  double voxelSize_;
};

}  // namespace

std::size_t promoteToCreases(Mesh& mesh, SideCounts& sides, double voxelSize, base::Job& job) {
  return Promoter(mesh, sides, voxelSize).run(job);
}

}  // namespace tufa::creases
