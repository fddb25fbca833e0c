#include "refine/order_along_creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

#include "base/sort_unique.h"
#include "uniform/block_ranges.h"
#include "uniform/quads.h"

namespace tufa::refine {
namespace {

// Voxels between two vertices on a crease, one after the other: just more than what
// withdrawPlacements() takes for the same point.
constexpr double kSpacing = 0.16;
// Voxels that a vertex may slide in all, as creases bend.
constexpr double kFarthest = 0.75;
constexpr int kMostOrderRounds = 64;
// What is left of a violated order counts for nothing, voxels.
constexpr double kSlack = 1e-3;
// Vertices are on one crease if its directions at them are within so many degrees (14), and one is
// within so many voxels of the line through the other.
constexpr double kSameDirection = 0.97;
constexpr double kSameLine = 0.15;
// A vertex is on a sheet within so many voxels of it, and if it has a normal, within so many
// degrees (25) of the sheet's.
constexpr double kMostAcross = 0.25;
constexpr double kSameNormal = 0.9;
// A vertex that is nearer to the crease than this, in voxels, does not tell on which side of it the
// sheet lies.
constexpr double kAside = 0.05;

// Along a direction of length 1, one vertex comes before another.
struct Order {
  VertexIndex first, second;
  Vec3 along;
};

bool isBefore(const Order& a, const Order& b) {
  return std::pair(a.first, a.second) < std::pair(b.first, b.second);
}
// Whatever the order in which threads have found them.
bool isBeforeInAll(const Order& a, const Order& b) {
  return std::tuple(a.first, a.second, a.along) < std::tuple(b.first, b.second, b.along);
}

// The quad's vertices on one crease, and which way it runs.
struct QuadAtCrease {
  std::array<bool, 4> isOn{};
  int count = 0;
  Vec3 along{0};
};

class CreaseOrder {
 public:
  CreaseOrder(uniform::UniformSurface& surface, base::Job& job)
      : surface_(surface),
        mesh_(surface.mesh),
        voxelSize_(surface.affine().voxelSize()),
        job_(job) {}

  std::size_t run() {
    findAtSheets();
    dropContradictions();
    if (orders_.empty()) return 0;
    findBetweenSheets();
    nameVertices();
    for (int round = 0; round < kMostOrderRounds && push(round == 0); ++round) {
      job_.checkCancelled(0, 1);
    }
    return apply();
  }

 private:
  [[nodiscard]] Vec3 pointOf(VertexIndex v) const {
    return Vec3(mesh_.positions[v]) * (1 / voxelSize_);
  }
  [[nodiscard]] Vec3 directionOf(VertexIndex v) const {
    const uniform::MeetingSheets sheets = surface_.sheets.sheets(mesh_, v);
    if (sheets.count != 2) return Vec3(0);
    Vec3 along = Vec3(sheets.normals[0]).cross(Vec3(sheets.normals[1]));
    return along.normalize() ? along : Vec3(0);
  }
  [[nodiscard]] bool isSharp(VertexIndex v) const {
    return surface_.sheets.kind(v) == uniform::VertexSheets::Kind::Meeting;
  }

  // The crease that most of the quad's vertices are on; corners are on it if it leads there.
  [[nodiscard]] QuadAtCrease atCrease(const Quad& quad) const {
    std::array<Vec3, 4> points, directions;
    std::array<bool, 4> isKnown{}, isCorner{};
    for (std::size_t i = 0; i < 4; ++i) {
      const VertexIndex v = quad.vertices[i];
      isKnown[i] = isSharp(v);
      if (!isKnown[i]) continue;
      points[i] = pointOf(v);
      directions[i] = directionOf(v);
      isCorner[i] = directions[i] == Vec3(0);
    }
    QuadAtCrease best;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!isKnown[i] || isCorner[i]) continue;
      QuadAtCrease at;
      at.along = directions[i];
      for (std::size_t k = 0; k < 4; ++k) {
        if (!isKnown[k]) continue;
        if (!isCorner[k] && std::abs(directions[k].dot(at.along)) < kSameDirection) continue;
        const Vec3 way = points[k] - points[i];
        if ((way - at.along * way.dot(at.along)).squaredLength() > kSameLine * kSameLine) continue;
        at.isOn[k] = true;
        ++at.count;
      }
      if (at.count > best.count) best = at;
    }
    return best;
  }

  // The normal of the sheet of the crease at vertex `on` that vertex `off` lies on; 0 if it is on
  // none of them, as around a corner, or on both.
  [[nodiscard]] Vec3 sheetOf(VertexIndex on, VertexIndex off) const {
    const uniform::MeetingSheets at = surface_.sheets.sheets(mesh_, on);
    const uniform::MeetingSheets own = surface_.sheets.sheets(mesh_, off);
    const Vec3 way = pointOf(off) - pointOf(on);
    Vec3 found(0);
    for (int i = 0; i < at.count; ++i) {
      const Vec3 normal(at.normals[i]);
      if (std::abs(normal.dot(way)) > kMostAcross) continue;
      if (own.count == 1 && normal.dot(Vec3(own.normals[0])) < kSameNormal) continue;
      if (!(found == Vec3(0))) return Vec3(0);
      found = normal;
    }
    return found;
  }

  // All quads at creases: those on a sheet give orders, those between two sheets are kept.
  void findAtSheets() {
    std::mutex mutex;
    job_.forRanges(mesh_.quads.size(), [&](std::size_t begin, std::size_t end) {
      std::vector<Order> found;
      std::vector<std::uint32_t> between;
      for (std::size_t q = begin; q < end; ++q) {
        const auto& v = mesh_.quads[q].vertices;
        if (std::count_if(v.begin(), v.end(), [&](VertexIndex x) { return isSharp(x); }) < 2) {
          continue;
        }
        const QuadAtCrease at = atCrease(mesh_.quads[q]);
        if (at.count == 4) {
          between.push_back(static_cast<std::uint32_t>(q));
        } else if (at.count >= 2) {
          addAtSheet(mesh_.quads[q], at, found);
        }
      }
      const std::scoped_lock lock(mutex);
      orders_.insert(orders_.end(), found.begin(), found.end());
      between_.insert(between_.end(), between.begin(), between.end());
    });
    std::sort(orders_.begin(), orders_.end(), isBeforeInAll);
    std::sort(between_.begin(), between_.end());
  }

  // The edges of a quad on a sheet that lie on the crease.
  void addAtSheet(const Quad& quad, const QuadAtCrease& at, std::vector<Order>& found) const {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t next = (i + 1) % 4, third = (i + 2) % 4, last = (i + 3) % 4;
      if (!at.isOn[i] || !at.isOn[next]) continue;
      const VertexIndex a = quad.vertices[i], b = quad.vertices[next];
      const VertexIndex on = directionOf(a) == Vec3(0) ? b : a;
      if (directionOf(on) == Vec3(0)) continue;
      const VertexIndex off = quad.vertices[at.isOn[last] ? third : last];
      const Vec3 normal = sheetOf(on, off);
      if (normal == Vec3(0)) continue;
      Vec3 inward = pointOf(off) - pointOf(on);
      inward -= at.along * inward.dot(at.along);
      const double way = inward.cross(normal).dot(at.along);
      if (std::abs(way) < kAside) continue;
      found.push_back({a, b, at.along * (way > 0 ? 1.0 : -1.0)});
    }
  }

  // Where two quads disagree, neither is believed.
  void dropContradictions() {
    std::vector<Order> kept;
    for (const Order& order : orders_) {
      const auto contradicts = [&](VertexIndex first, VertexIndex second, double sign) {
        auto at = std::lower_bound(orders_.begin(), orders_.end(), Order{first, second, Vec3(0)},
                                   isBefore);
        for (; at != orders_.end() && at->first == first && at->second == second; ++at) {
          if (sign * at->along.dot(order.along) < 0) return true;
        }
        return false;
      };
      if (!contradicts(order.first, order.second, 1) &&
          !contradicts(order.second, order.first, -1)) {
        kept.push_back(order);
      }
    }
    orders_ = std::move(kept);
  }

  [[nodiscard]] const Order* orderOf(VertexIndex a, VertexIndex b) const {
    for (const auto& [first, second] : {std::pair(a, b), std::pair(b, a)}) {
      const Order key{first, second, Vec3(0)};
      const auto at = std::lower_bound(orders_.begin(), orders_.end(), key, isBefore);
      if (at != orders_.end() && at->first == first && at->second == second) return &*at;
    }
    return nullptr;
  }

  // Quads with all vertices on the crease, between a side on one sheet and a side on the other.
  void findBetweenSheets() {
    std::vector<Order> found;
    for (const std::uint32_t q : between_) {
      const Quad& quad = mesh_.quads[q];
      std::array<const Order*, 4> known{};
      for (std::size_t i = 0; i < 4; ++i) {
        known[i] = orderOf(quad.vertices[i], quad.vertices[(i + 1) % 4]);
      }
      const std::size_t side = known[0] != nullptr || known[2] != nullptr ? 0 : 1;
      if (known[1 - side] != nullptr || known[3 - side] != nullptr) continue;
      const Order* const order = known[side] != nullptr ? known[side] : known[side + 2];
      if (order == nullptr) continue;
      // a - b is the side with the order, d - c the other one.
      const std::size_t first = known[side] != nullptr ? side : side + 2;
      VertexIndex a = quad.vertices[first], b = quad.vertices[(first + 1) % 4];
      VertexIndex c = quad.vertices[(first + 2) % 4], d = quad.vertices[(first + 3) % 4];
      if (order->first != a) std::swap(a, b), std::swap(c, d);
      found.push_back({d, c, order->along});
      found.push_back({a, c, order->along});
      found.push_back({d, b, order->along});
    }
    orders_.insert(orders_.end(), found.begin(), found.end());
  }

  void nameVertices() {
    for (const Order& order : orders_) {
      vertices_.push_back(order.first);
      vertices_.push_back(order.second);
    }
    base::sortUnique(vertices_);
    for (const VertexIndex v : vertices_) directions_.push_back(directionOf(v));
    slides_.assign(vertices_.size(), 0);
    up_ = down_ = slides_;
    hasMoved_.assign(vertices_.size(), 0);
    for (Order& order : orders_) {
      order.first = nameOf(order.first);
      order.second = nameOf(order.second);
    }
  }
  [[nodiscard]] VertexIndex nameOf(VertexIndex v) const {
    return static_cast<VertexIndex>(std::lower_bound(vertices_.begin(), vertices_.end(), v) -
                                    vertices_.begin());
  }
  [[nodiscard]] Vec3 placeOf(VertexIndex name) const {
    return pointOf(vertices_[name]) + directions_[name] * slides_[name];
  }

  // Both vertices of an order that does not hold give way by half of what is missing, all at once.
  // After the first round only orders of vertices that have moved are looked at. Whether any moved.
  bool push(bool isFirst) {
    std::fill(up_.begin(), up_.end(), 0);
    std::fill(down_.begin(), down_.end(), 0);
    bool any = false;
    for (const Order& order : orders_) {
      if (!isFirst && hasMoved_[order.first] == 0 && hasMoved_[order.second] == 0) continue;
      const double missing =
          kSpacing - (placeOf(order.second) - placeOf(order.first)).dot(order.along);
      if (missing < kSlack) continue;
      const double back = directions_[order.first].dot(order.along);
      const double forth = directions_[order.second].dot(order.along);
      const double share = back != 0 && forth != 0 ? missing / 2 : missing;
      const auto pushOne = [&](VertexIndex name, double way) {
        double& most = way > 0 ? up_[name] : down_[name];
        if (way != 0) most = std::max(most, share);
      };
      pushOne(order.first, -back);
      pushOne(order.second, forth);
      any = true;
    }
    if (!any) return false;
    for (std::size_t i = 0; i < slides_.size(); ++i) {
      if (up_[i] == 0 && down_[i] == 0) continue;
      const double way = up_[i] > 0 && down_[i] > 0 ? (up_[i] - down_[i]) / 2 : up_[i] - down_[i];
      slides_[i] = std::clamp(slides_[i] + way, -kFarthest, kFarthest);
      hasMoved_[i] = 1;
    }
    return true;
  }

  std::size_t apply() {
    std::vector<std::uint8_t> marks(mesh_.positions.size(), 0);
    std::vector<VertexIndex> moved;
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      if (slides_[i] == 0) continue;
      const Vec3 to =
          Vec3(mesh_.positions[vertices_[i]]) + directions_[i] * (slides_[i] * voxelSize_);
      mesh_.positions[vertices_[i]] = to;
      surface_.sheets.setOutOfCell(vertices_[i]);
      marks[vertices_[i]] = 1;
      moved.push_back(vertices_[i]);
    }
    uniform::splitAgain(surface_.view(),
                        uniform::quadsAt(surface_.topology, mesh_, moved, marks, job_), mesh_,
                        job_);
    return moved.size();
  }

  uniform::UniformSurface& surface_;
  Mesh& mesh_;
  double voxelSize_;
  base::Job& job_;
  std::vector<Order> orders_;           // of vertices of the mesh, then of those below
  std::vector<std::uint32_t> between_;  // quads
  std::vector<VertexIndex> vertices_;
  std::vector<Vec3> directions_;   // of each vertex's crease; 0 at corners, which stay
  std::vector<double> slides_;     // voxels along it
  std::vector<double> up_, down_;  // what a round pushes it
  std::vector<std::uint8_t> hasMoved_;
};

}  // namespace

std::size_t orderAlongCreases(uniform::UniformSurface& surface, base::Job& job) {
  if (surface.mesh.normals.empty() || surface.sheets.sharpCount() == 0) return 0;
  return CreaseOrder(surface, job).run();
}

}  // namespace tufa::refine
