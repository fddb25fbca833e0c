// Distances to meshes, with the sign of Baerentzen and Aanaes (2005).
#include "implicit/mesh_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/box.h"
#include "base/bvh.h"
#include "base/flat_triangle.h"
#include "base/job.h"
#include "base/sheared_ray.h"
#include "implicit/boxes.h"
#include "implicit/interval.h"
#include "implicit/mesh_topology.h"
#include "implicit/spans.h"

namespace tufa::implicit {
namespace {

/// The point of a triangle that is nearest to another one, and what it lies on.
struct Foot {
  Vec3 point;
  int corner = -1;  ///< it lies in that one, or
  int edge = -1;    ///< on the one from this corner to the next, or else in the inside
};

Foot footOnEdge(const Vec3& p, const std::array<Vec3, 3>& corners, int edge) {
  const int next = (edge + 1) % 3;
  const Vec3 side = corners[next] - corners[edge];
  const double share = side.dot(p - corners[edge]) / side.squaredLength();
  if (!(share > 0)) return {corners[edge], edge, -1};
  if (share >= 1) return {corners[next], next, -1};
  return {corners[edge] + side * share, -1, edge};
}

Foot footIn(const Vec3& p, const std::array<Vec3, 3>& corners, const base::FlatTriangle& flat) {
  double squared = 0;
  if (flat.isAbove(p, squared)) {
    return {p - flat.normal() * flat.normal().dot(p - corners[0])};
  }
  Foot best = footOnEdge(p, corners, 0);
  for (int edge = 1; edge < 3; ++edge) {
    const Foot foot = footOnEdge(p, corners, edge);
    if ((p - foot.point).squaredLength() < (p - best.point).squaredLength()) best = foot;
  }
  return best;
}

/// Unit vectors among the weighted means of those in a box.
Box unitVectors(const Box& box) {
  const Vec3 nearest = maxVec3(box.least, minVec3(box.greatest, Vec3(0.0)));
  const double shortest = nearest.length();
  if (!(shortest > 0)) return {Vec3(-1), Vec3(1)};
  std::array<Interval, 3> sides;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sides[axis] = both(sideOf(box, axis) * Interval{1, 1 / shortest}, {-1, 1});
  }
  return boxOf(sides);
}

/// Triangles made ready to be asked for the nearest place.
class Triangles {
 public:
  Triangles(const Mesh& mesh, bool isClosed) : set_(trianglesOf(mesh)) {
    if (isClosed) neighbours_ = neighboursIn(set_);
    std::vector<base::Box> boxes;
    for (std::uint32_t n = 0; n < set_.triangles.size(); ++n) {
      const std::array<Vec3, 3> p = corners(n);
      flat_.emplace_back(p[0], p[1], p[2]);
      base::Box box = base::Box::empty();
      for (const Vec3& corner : p) box.add(corner);
      boxes.push_back(box);
      extent_ = n == 0 ? Box{box.lower, box.upper} : hull(extent_, {box.lower, box.upper});
    }
    if (isClosed) findNormals();
    base::Job job(0, {});
    job.run([&] { tree_ = std::make_unique<base::Bvh>(std::move(boxes), job); });
  }

  [[nodiscard]] const Box& extent() const { return extent_; }
  [[nodiscard]] const base::Bvh& tree() const { return *tree_; }
  /// Of closed meshes: all gradients where a triangle is nearest, and perhaps some more.
  [[nodiscard]] const Box& cone(std::uint32_t triangle) const { return cones_[triangle]; }
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    return set_.cornersOf(set_.triangles[triangle]);
  }
  [[nodiscard]] double squaredDistance(const Vec3& p, std::uint32_t triangle) const {
    return flat_[triangle].squaredDistance(p);
  }
  [[nodiscard]] Foot foot(const Vec3& p, std::uint32_t triangle) const {
    return footIn(p, corners(triangle), flat_[triangle]);
  }

  /// Of closed meshes. Of corners and edges the mean of their faces', by angle: the sign of its
  /// product with the way from there to a point that nothing else is nearer to is that of the
  /// distance.
  [[nodiscard]] Vec3 normalAt(std::uint32_t triangle, const Foot& foot) const {
    if (foot.corner >= 0) return normals_[set_.triangles[triangle][foot.corner]];
    Vec3 normal = flat_[triangle].normal();
    if (foot.edge >= 0) normal += flat_[neighbours_[triangle][foot.edge]].normal();
    return normal.unitOrX();
  }

 private:
  void findNormals() {
    normals_.assign(set_.positions.size(), Vec3(0.0));
    std::vector<Box> around(set_.positions.size(), Box{Vec3(kInfinity), Vec3(-kInfinity)});
    for (std::uint32_t n = 0; n < set_.triangles.size(); ++n) {
      const std::array<Vec3, 3> p = corners(n);
      const Vec3 normal = flat_[n].normal();
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 one = p[(k + 1) % 3] - p[k];
        const Vec3 other = p[(k + 2) % 3] - p[k];
        const std::uint32_t vertex = set_.triangles[n][k];
        normals_[vertex] += normal * std::atan2(one.cross(other).length(), one.dot(other));
        around[vertex] = hull(around[vertex], {normal, normal});
      }
    }
    for (Vec3& normal : normals_) normal = normal.unitOrX();
    // A gradient at a corner or an edge lies between the normals of the faces there.
    for (const auto& v : set_.triangles) {
      const Box all = hull(around[v[0]], hull(around[v[1]], around[v[2]]));
      cones_.push_back(grown(unitVectors(all), 1e-12));
    }
  }

  TriangleSet set_;
  Box extent_;
  std::vector<base::FlatTriangle> flat_;
  std::vector<std::array<std::uint32_t, 3>> neighbours_;  ///< of closed meshes, beyond each edge
  std::vector<Vec3> normals_;                             ///< of closed meshes, at each vertex
  std::vector<Box> cones_;
  std::unique_ptr<base::Bvh> tree_;
};

class MeshDistance final : public Field {
 public:
  /// A solid, or a sheet of that half thickness. Where `few` are given, no other triangles are
  /// nearest.
  MeshDistance(std::shared_ptr<const Triangles> triangles, std::optional<double> halfThickness,
               std::vector<std::uint32_t> few = {})
      : triangles_(std::move(triangles)), half_(halfThickness), few_(std::move(few)) {}

  [[nodiscard]] double value(const Position& p) const override {
    const Near near = nearestTo(p);
    return near.side * near.distance - half_.value_or(0);
  }

  /// Of a solid, at a point that is no farther than `most` from it.
  [[nodiscard]] double valueWithin(const Vec3& p, double most) const {
    constexpr double kRounding = 1e-9;
    Near near = nearestTo(p, most * (1 + kRounding));
    if (near.distance == kInfinity) near = nearestTo(p);  // as on the surface, if `most` is 0
    return near.side * near.distance;
  }

  [[nodiscard]] Position gradient(const Position& p) const override {
    const Near near = nearestTo(p);
    Vec3 along = near.offset * near.side;
    if (along.normalize(0)) return along;
    return near.normal;
  }

  [[nodiscard]] Interval bound(const Box& box) const override {
    return aroundCentre(value(centreOf(box)), 1, box);
  }
  [[nodiscard]] double lipschitz(const Box& /*box*/) const override { return 1; }

  // It points from the nearest place, which lies near that of the box's centre on one of a few
  // triangles; and where that is on the mesh, between the normals of the faces around it.
  [[nodiscard]] Box gradientBound(const Box& box) const override {
    const Box any{Vec3(-1), Vec3(1)};
    const Vec3 centre = centreOf(box);
    const double reach = halfOf(box).length();
    constexpr double kSmall = 0.1;
    if (!(reach < kSmall * halfOf(triangles_->extent()).length())) return any;
    const Near near = nearestTo(centre);
    Box all{Vec3(kInfinity), Vec3(-kInfinity)};
    constexpr int kMost = 64;
    int count = 0;
    forNear(centre, near.distance, reach, [&](std::uint32_t n, const Vec3& offset, double left) {
      Box slopes = any;
      if (near.distance > reach) {
        // A triangle is convex: what of it is as near lies around the foot.
        slopes = slopesFrom(offset * near.side, reach + std::sqrt(left),
                            {near.distance - reach, near.distance + reach});
      }
      if (!half_) slopes = both(slopes, triangles_->cone(n));
      all = hull(all, slopes);
      return ++count > kMost;
    });
    if (count > kMost) return any;
    return both(all, any);
  }

  [[nodiscard]] bool hasUnitGradient() const override { return true; }
  [[nodiscard]] Box extent() const override {
    return grown(triangles_->extent(), half_.value_or(0));
  }

  [[nodiscard]] FieldPtr restricted(const Box& box) const override {
    constexpr std::size_t kMost = 16;
    const Vec3 centre = centreOf(box);
    const double reach = halfOf(box).length();
    if (!(reach < halfOf(triangles_->extent()).length())) return nullptr;
    const std::size_t most = few_.empty() ? kMost : few_.size() - 1;
    std::vector<std::uint32_t> few;
    forNear(centre, nearestTo(centre).distance, reach,
            [&](std::uint32_t n, const Vec3& /*offset*/, double /*left*/) {
              few.push_back(n);
              return few.size() > most;
            });
    if (few.empty() || few.size() > most) return nullptr;
    return std::make_shared<MeshDistance>(triangles_, half_, std::move(few));
  }

  // The sides of the stretches between all places where a line passes triangles.
  [[nodiscard]] bool insideAlong(const Line& line, double begin, double end,
                                 std::vector<Interval>& spans) const override {
    if (half_) return false;
    const Vec3 from = line.from;
    const Vec3 direction = line.direction;
    const base::ShearedRay sheared(from, direction);
    std::vector<double> ends{begin, end};
    double to = end;
    triangles_->tree().itemsAlong({from, direction, begin}, to, [&](std::uint32_t n) {
      const auto at = sheared.passes(triangles_->corners(n));
      if (at && *at > begin && *at < end) ends.push_back(*at);
    });
    std::sort(ends.begin(), ends.end());
    const std::size_t first = spans.size();
    for (std::size_t n = 1; n < ends.size(); ++n) {
      // Neighbours are passed at one place, but for rounding.
      constexpr double kSame = 1e-13;
      if (!(ends[n] - ends[n - 1] > kSame * std::max(std::abs(ends[n]), std::abs(ends[n - 1])))) {
        continue;
      }
      if (!(value(from + direction * ((ends[n - 1] + ends[n]) / 2)) < 0)) continue;
      // What lies beyond the ends is not known: no surface is at them.
      const double least = n == 1 ? -kInfinity : ends[n - 1];
      const double greatest = n + 1 == ends.size() ? kInfinity : ends[n];
      spans.push_back({least, greatest});
    }
    uniteFrom(spans, first);
    return true;
  }

 private:
  struct Near {
    double distance = kInfinity;
    Vec3 offset{kInfinity};  ///< from the nearest place
    double side = 1;         ///< -1 inside
    Vec3 normal{0.0};        ///< there, of a solid
  };

  /// Infinitely far if nothing is nearer than `most`.
  [[nodiscard]] Near nearestTo(const Vec3& p, double most = kInfinity) const {
    double best = most * most;
    std::uint32_t triangle = base::Bvh::kNone;
    const auto squared = [&](std::uint32_t n) { return triangles_->squaredDistance(p, n); };
    if (few_.empty()) triangle = triangles_->tree().nearest(p, best, squared);
    for (const std::uint32_t n : few_) {
      const double own = squared(n);
      if (own >= best) continue;
      best = own;
      triangle = n;
    }
    Near near;
    if (triangle == base::Bvh::kNone) return near;
    const Foot foot = triangles_->foot(p, triangle);
    near.distance = std::sqrt(best);
    near.offset = p - foot.point;
    if (half_) return near;
    near.normal = triangles_->normalAt(triangle, foot);
    near.side = near.normal.dot(near.offset) < 0 ? -1 : 1;
    return near;
  }

  /// Calls visit(triangle, offset of the centre from its nearest place, left) for all triangles
  /// that may be nearest to a point within `reach` of a centre, until it returns true: in a
  /// triangle such a place has a squared distance of at most `left` from the centre's.
  template <class Visit>
  void forNear(const Vec3& centre, double distance, double reach, const Visit& visit) const {
    const double most = (distance + 2 * reach) * (1 + 1e-9);
    const auto look = [&](std::uint32_t n) {
      const Vec3 offset = centre - triangles_->foot(centre, n).point;
      const double left = most * most - offset.squaredLength();
      return left >= 0 && visit(n, offset, left);
    };
    if (few_.empty()) {
      triangles_->tree().itemsMeetingUntil({centre - Vec3(most), centre + Vec3(most)}, look);
    } else {
      static_cast<void>(std::any_of(few_.begin(), few_.end(), look));
    }
  }

  /// Of points of which the offset from the nearest place is known up to `room`, and its length.
  static Box slopesFrom(const Vec3& offset, double room, const Interval& length) {
    std::array<Interval, 3> sides;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sides[axis] = both(Interval{offset[axis] - room, offset[axis] + room} / length, {-1, 1});
    }
    return boxOf(sides);
  }

  std::shared_ptr<const Triangles> triangles_;
  std::optional<double> half_;  ///< of sheets
  std::vector<std::uint32_t> few_;
};

}  // namespace

FieldPtr makeMeshSolid(const Mesh& mesh) {
  return std::make_shared<MeshDistance>(std::make_shared<const Triangles>(mesh, true),
                                        std::nullopt);
}

SignedDistance signedDistanceTo(const Mesh& mesh) {
  return [solid = std::make_shared<const MeshDistance>(
              std::make_shared<const Triangles>(mesh, true), std::nullopt)](
             const Vec3& p, double most) { return solid->valueWithin(p, most); };
}

FieldPtr makeMeshSheet(const Mesh& mesh, double thickness) {
  return std::make_shared<MeshDistance>(std::make_shared<const Triangles>(mesh, false),
                                        thickness / 2);
}

}  // namespace tufa::implicit
