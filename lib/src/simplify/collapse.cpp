#include "simplify/collapse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "base/flat_triangle.h"
#include "simplify/edge_queue.h"

namespace tufa::simplify {
namespace {

using base::FlatTriangle;
using openvdb::Vec3d;

constexpr std::uint32_t kNone = ~std::uint32_t{0};
// Weight of an edge's squared length beside its error, so that flat places are thinned evenly.
constexpr double kLengthShare = 1e-4;
// Least cosine between the normals of a triangle before and after.
// Least cosine between the normals of two triangles at an edge.
constexpr double kFold = -0.3;
// Cosine of the angle up to which a sample's normal and a triangle's belong to one side.
constexpr double kOneSide = 0.9;
constexpr double kLeastTurn = 0.5;
// Triangles are kept this round (1: equilateral), or no worse than this share of what they were.
constexpr double kRound = 0.2;
constexpr double kWorse = 0.7;

Vec3d vectorOf(const Position& p) { return {p.x, p.y, p.z}; }

double roundness(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double squares = (b - a).lengthSqr() + (c - b).lengthSqr() + (a - c).lengthSqr();
  return squares > 0 ? 2 * std::sqrt(3.0) * (b - a).cross(c - a).length() / squares : 0;
}

class Collapser {
 public:
  Collapser(const Mesh& mesh, const std::vector<PlaneSum>& planes, const Bounds& bounds)
      : mesh_(mesh), bounds_(bounds) {
    start(planes, bounds.before);
    setRanks();
    if (bounds.before != nullptr && !(keepsEuler() && isManifold())) start(planes, nullptr);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (vertexOf_[i] == i && isOnBoundary(i)) allowed_[i] = 0;
    }
    firstSample_.assign(corners_.size() / 3, kNone);
    nextSample_.resize(bounds_.samples.size());
    sampleTriangles_.resize(bounds_.samples.size());
    for (std::uint32_t i = 0; i < bounds_.samples.size(); ++i) attach(i, locate(i));
  }

  void run(base::Job& job) {
    for (const VertexIndex a : order_) {
      if (vertexOf_[a] != a) continue;
      collectNeighbours(a, aroundA_);
      for (const VertexIndex b : aroundA_) {
        if (ranks_[a] < ranks_[b] && (isNearOpen(a) || isNearOpen(b))) propose(a, b);
      }
    }
    constexpr std::size_t kBetweenLooks = 4096;
    const std::size_t all = alive_;
    EdgeQueue::Entry best{};
    for (std::size_t steps = 0; alive_ > bounds_.triangles && queue_.pop(best); ++steps) {
      if (steps % kBetweenLooks == 0) job.look(all - alive_, all);
      if (best.versionA != version_[best.a] || best.versionB != version_[best.b]) continue;
      const Edge edge = solve(best.a, best.b);
      if (canCollapse(edge)) apply(edge);
    }
  }

  [[nodiscard]] Collapsed result() const {
    Collapsed out;
    out.sampleTriangles = sampleTriangles_;
    std::vector<VertexIndex> numbers(points_.size(), kNone);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (vertexOf_[i] != i) continue;
      numbers[i] = static_cast<VertexIndex>(out.mesh.positions.size());
      out.mesh.positions.emplace_back(points_[i][0], points_[i][1], points_[i][2]);
      out.mesh.normals.push_back(normalOf(static_cast<VertexIndex>(i)));
    }
    out.members.resize(out.mesh.positions.size());
    out.vertexOf.resize(points_.size());
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      out.vertexOf[i] = numbers[rootOf(i)];
      ++out.members[out.vertexOf[i]];
    }
    const auto corner = [&](std::size_t i) { return numbers[corners_[i]]; };
    std::vector<std::uint32_t> sources;
    for (std::uint32_t polygon = 0; polygon < mesh_.quads.size(); ++polygon) {
      const std::size_t t = std::size_t{6} * polygon;
      const bool first = isAlive(t), second = isAlive(t + 3);
      if (first && second) {
        out.mesh.quads.emplace_back(corner(t), corner(t + 1), corner(t + 2), corner(t + 5));
        out.sources.push_back(polygon);
      } else if (first || second) {
        const std::size_t s = first ? t : t + 3;
        out.mesh.triangles.emplace_back(corner(s), corner(s + 1), corner(s + 2));
        sources.push_back(polygon);
      }
    }
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const std::size_t t = 6 * mesh_.quads.size() + 3 * i;
      if (!isAlive(t)) continue;
      out.mesh.triangles.emplace_back(corner(t), corner(t + 1), corner(t + 2));
      sources.push_back(static_cast<std::uint32_t>(mesh_.quads.size() + i));
    }
    out.sources.insert(out.sources.end(), sources.begin(), sources.end());
    return out;
  }

 private:
  struct Edge {
    VertexIndex a, b;
    Vec3d point;   ///< that takes the place of both
    double error;  ///< sum of squared distances to its planes
    double planes;
  };

  [[nodiscard]] bool isAlive(std::size_t t) const { return corners_[t] != kNone; }
  [[nodiscard]] VertexIndex rootOf(VertexIndex vertex) const {
    while (vertexOf_[vertex] != vertex) vertex = vertexOf_[vertex];
    return vertex;
  }
  // Calls visit(triangle's first corner, the two corners after the vertex in order).
  template <class Visit>
  void forTriangles(VertexIndex vertex, const Visit& visit) const {
    for (std::uint32_t corner = first_[vertex]; corner != kNone; corner = next_[corner]) {
      if (corners_[corner] != vertex) continue;  // of a triangle that is gone
      const std::uint32_t t = corner - corner % 3;
      visit(t, corners_[t + (corner + 1) % 3], corners_[t + (corner + 2) % 3]);
    }
  }
  [[nodiscard]] bool isOnBoundary(VertexIndex vertex) const {
    // Around an inner vertex each neighbour follows once and leads once.
    std::int64_t balance = 0;
    std::size_t triangles = 0;
    forTriangles(vertex, [&](std::uint32_t, VertexIndex x, VertexIndex y) {
      balance += std::int64_t{x} - std::int64_t{y};
      ++triangles;
    });
    return triangles < 3 || balance != 0;
  }
  [[nodiscard]] Normal normalOf(VertexIndex vertex) const {
    Vec3d sum = planes_[vertex].normals;
    if (version_[vertex] == 0 || !sum.normalize()) return mesh_.normals[vertex];
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
  }

  // The mesh as it is given, or with what `before` joined and is not reopened.
  void start(std::vector<PlaneSum> planes, const Collapsed* before) {
    planes_ = std::move(planes);
    allowed_ = bounds_.allowed;
    const std::size_t vertices = mesh_.positions.size();
    points_.clear();
    for (const Position& p : mesh_.positions) points_.push_back(vectorOf(p));
    version_.assign(vertices, 0);
    vertexOf_.resize(vertices);
    for (std::uint32_t i = 0; i < vertices; ++i) vertexOf_[i] = i;
    open_.clear();
    if (before != nullptr) joinAgain(*before);
    corners_.clear();
    for (const Quad& quad : mesh_.quads) {
      const auto& v = quad.vertices;
      corners_.insert(corners_.end(), {v[0], v[1], v[2], v[0], v[2], v[3]});
    }
    for (const Triangle& triangle : mesh_.triangles) {
      corners_.insert(corners_.end(), triangle.vertices.begin(), triangle.vertices.end());
    }
    alive_ = 0;
    first_.assign(vertices, kNone);
    next_.assign(corners_.size(), kNone);
    for (std::uint32_t t = 0; t < corners_.size(); t += 3) {
      std::uint32_t* v = &corners_[t];
      for (int i = 0; i < 3; ++i) v[i] = vertexOf_[v[i]];
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        std::fill_n(v, 3, kNone);
        continue;
      }
      ++alive_;
      for (std::uint32_t i = 0; i < 3; ++i) {
        next_[t + i] = first_[v[i]];
        first_[v[i]] = t + i;
      }
    }
  }

  // By place: a grid that is moved has its vertices in another order.
  void setRanks() {
    std::vector<VertexIndex> order(points_.size());
    std::iota(order.begin(), order.end(), VertexIndex{0});
    std::sort(order.begin(), order.end(), [&](VertexIndex a, VertexIndex b) {
      const Position& p = mesh_.positions[a];
      const Position& q = mesh_.positions[b];
      return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
    });
    ranks_.resize(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) ranks_[order[i]] = i;
    order_ = std::move(order);
  }

  void joinAgain(const Collapsed& before) {
    open_ = bounds_.reopened;
    std::vector<VertexIndex> rootOfGroup(before.mesh.positions.size(), kNone);
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      const VertexIndex group = before.vertexOf[i];
      if (open_[i] != 0 || before.members[group] < 2) continue;
      const Vec3d at = vectorOf(before.mesh.positions[group]);
      const PlaneSum moved = planes_[i].seenFrom(at - vectorOf(mesh_.positions[i]));
      VertexIndex& root = rootOfGroup[group];
      if (root == kNone) {
        root = i;
        planes_[i] = moved;
        points_[i] = at;
        version_[i] = 1;
      } else {
        planes_[root] += moved;
        allowed_[root] = std::min(allowed_[root], allowed_[i]);
      }
      vertexOf_[i] = root;
    }
  }

  // A collapse takes away one vertex and two triangles.
  [[nodiscard]] bool keepsEuler() const {
    std::size_t gone = 0;
    for (std::uint32_t i = 0; i < vertexOf_.size(); ++i) gone += vertexOf_[i] != i ? 1 : 0;
    return alive_ + 2 * gone == corners_.size() / 3;
  }

  // Whether the triangles around each vertex are one fan, open or closed, of different neighbours.
  [[nodiscard]] bool isManifold() {
    std::vector<VertexIndex> leading, following;
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      if (first_[i] == kNone) continue;
      leading.clear();
      following.clear();
      forTriangles(i, [&](std::uint32_t, VertexIndex x, VertexIndex y) {
        leading.push_back(x);
        following.push_back(y);
      });
      // Walks around from the start of the fan, if it has one.
      std::size_t at = 0;
      for (std::size_t k = 0; k < leading.size(); ++k) {
        if (std::find(following.begin(), following.end(), leading[k]) == following.end()) at = k;
      }
      std::size_t walked = 1;
      const VertexIndex start = leading[at];
      for (; walked <= leading.size(); ++walked) {
        const auto next = std::find(leading.begin(), leading.end(), following[at]);
        if (next == leading.end() || *next == start) break;
        at = static_cast<std::size_t>(next - leading.begin());
      }
      std::sort(leading.begin(), leading.end());
      if (walked != leading.size() || hasTwice(leading)) return false;
    }
    return true;
  }

  [[nodiscard]] bool isNearOpen(VertexIndex vertex) const {
    if (open_.empty() || open_[vertex] != 0) return true;
    bool near = false;
    forTriangles(vertex, [&](std::uint32_t, VertexIndex x, VertexIndex) { near |= open_[x] != 0; });
    return near;
  }

  // The first corner of the triangle that a sample is nearest to: of those that came from its
  // polygon or are around its corners, or what was found before.
  [[nodiscard]] std::uint32_t locate(std::uint32_t sample) const {
    if (!open_.empty() && sample < bounds_.before->sampleTriangles.size()) {
      const std::uint32_t t = bounds_.before->sampleTriangles[sample];
      const auto settled = [&](std::uint32_t corner) { return open_[corners_[corner]] == 0; };
      if (isAlive(t) && settled(t) && settled(t + 1) && settled(t + 2)) return t;
    }
    const std::size_t polygon = bounds_.samples[sample].polygon, quads = mesh_.quads.size();
    const Vec3d at = vectorOf(bounds_.samples[sample].point);
    std::uint32_t nearest = kNone;
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](const auto& vertices) {
      for (const VertexIndex vertex : vertices) {
        forTriangles(rootOf(vertex), [&](std::uint32_t t, VertexIndex, VertexIndex) {
          const double squared =
              FlatTriangle(points_[corners_[t]], points_[corners_[t + 1]], points_[corners_[t + 2]])
                  .squaredDistance(at);
          if (squared >= least) return;
          least = squared;
          nearest = t;
        });
      }
    };
    polygon < quads ? look(mesh_.quads[polygon].vertices)
                    : look(mesh_.triangles[polygon - quads].vertices);
    return nearest;
  }
  void attach(std::uint32_t sample, std::uint32_t t) {
    sampleTriangles_[sample] = t;
    nextSample_[sample] = firstSample_[t / 3];
    firstSample_[t / 3] = sample;
  }

  [[nodiscard]] Edge solve(VertexIndex a, VertexIndex b) const {
    const Vec3d middle = (points_[a] + points_[b]) * 0.5;
    PlaneSum planes = planes_[a].seenFrom(middle - points_[a]);
    planes += planes_[b].seenFrom(middle - points_[b]);
    Vec3d offset = planes.least();
    if (!(offset.lengthSqr() <= (points_[a] - points_[b]).lengthSqr())) offset = Vec3d(0.0);
    return {a, b, middle + offset, planes.at(offset), planes.count};
  }

  void propose(VertexIndex a, VertexIndex b) {
    if (ranks_[b] < ranks_[a]) std::swap(a, b);
    const auto allowed = static_cast<double>(std::min(allowed_[a], allowed_[b]));
    if (!(allowed > 0)) return;
    const Edge edge = solve(a, b);
    if (edge.error > allowed * allowed * edge.planes) return;
    const double squaredLength = (points_[a] - points_[b]).lengthSqr();
    queue_.push(edge.error + kLengthShare * squaredLength, {a, b, version_[a], version_[b]});
  }

  // Neighbours of a vertex, sorted by place.
  void collectNeighbours(VertexIndex vertex, std::vector<VertexIndex>& out) const {
    out.clear();
    forTriangles(vertex, [&](std::uint32_t, VertexIndex x, VertexIndex) { out.push_back(x); });
    std::sort(out.begin(), out.end(),
              [&](VertexIndex a, VertexIndex b) { return ranks_[a] < ranks_[b]; });
  }

  // An edge of four triangles, as a quad's diagonal may be.
  static bool hasTwice(const std::vector<VertexIndex>& sorted) {
    return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
  }

  // The link condition for an edge off the boundary, and no vertex left with two triangles.
  bool keepsTopology(VertexIndex a, VertexIndex b) {
    collectNeighbours(a, aroundA_);
    collectNeighbours(b, aroundB_);
    common_.clear();
    std::set_intersection(aroundA_.begin(), aroundA_.end(), aroundB_.begin(), aroundB_.end(),
                          std::back_inserter(common_),
                          [&](VertexIndex x, VertexIndex y) { return ranks_[x] < ranks_[y]; });
    if (common_.size() != 2 || hasTwice(aroundA_) || hasTwice(aroundB_)) return false;
    std::array<VertexIndex, 2> beside{kNone, kNone};
    int count = 0;
    forTriangles(a, [&](std::uint32_t, VertexIndex x, VertexIndex y) {
      if (x == b || y == b) beside[std::min(count++, 1)] = x == b ? y : x;
    });
    if (count != 2 || !std::is_permutation(beside.begin(), beside.end(), common_.begin())) {
      return false;
    }
    for (const VertexIndex vertex : common_) {
      std::size_t triangles = 0;
      forTriangles(vertex, [&](std::uint32_t, VertexIndex, VertexIndex) { ++triangles; });
      if (triangles <= 3) return false;
    }
    return true;
  }

  // The triangles around a and b with both at `point`. False if one turns over or becomes a needle.
  bool collectRing(const Edge& edge) {
    ring_.clear();
    ringTriangles_.clear();
    ringEdges_.clear();
    star_.clear();
    double before = 1, after = 1;
    bool upright = true;
    const auto take = [&](VertexIndex own, VertexIndex other) {
      forTriangles(own, [&](std::uint32_t t, VertexIndex x, VertexIndex y) {
        const Vec3d& p = points_[own];
        before = std::min(before, roundness(p, points_[x], points_[y]));
        if (x == other || y == other) {
          if (own < other) star_.push_back(t);
          return;
        }
        star_.push_back(t);
        ringTriangles_.push_back(t);
        ringEdges_.push_back({x, y});
        const Vec3d was = (points_[x] - p).cross(points_[y] - p);
        const Vec3d is = (points_[x] - edge.point).cross(points_[y] - edge.point);
        after = std::min(after, roundness(edge.point, points_[x], points_[y]));
        const double along = was.dot(is);
        upright &= along > 0 &&
                   along * along >= kLeastTurn * kLeastTurn * was.lengthSqr() * is.lengthSqr();
        ring_.emplace_back(edge.point, points_[x], points_[y]);
      });
    };
    take(edge.a, edge.b);
    take(edge.b, edge.a);
    return upright && after >= std::min(kRound, kWorse * before);
  }

  // The triangle of the ring that is nearest to the point, and its squared distance.
  [[nodiscard]] std::pair<std::size_t, double> nearestInRing(const Vec3d& point) const {
    std::pair<std::size_t, double> best{0, std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      double squared = 0;
      if (ring_[i].isAbove(point, squared) && squared < best.second) best = {i, squared};
    }
    if (!std::isinf(best.second)) return best;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const double squared = ring_[i].squaredDistance(point);
      if (squared < best.second) best = {i, squared};
    }
    return best;
  }

  // No triangle of the ring is folded back over a neighbour, in the ring or outside.
  [[nodiscard]] bool staysUnfolded() const {
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const auto [x, y] = ringEdges_[i];
      bool flat = true;
      const auto look = [&](const Vec3d& normal) { flat &= ring_[i].normal().dot(normal) > kFold; };
      for (std::size_t j = 0; j < i; ++j) {
        if (ringEdges_[j][0] == y || ringEdges_[j][1] == x) look(ring_[j].normal());
      }
      forTriangles(y, [&](std::uint32_t, VertexIndex next, VertexIndex last) {
        if (next != x) return;
        Vec3d normal = (points_[x] - points_[y]).cross(points_[last] - points_[y]);
        if (normal.normalize()) look(normal);
      });
      if (!flat) return false;
    }
    return true;
  }

  // Whether all samples of the triangles around a and b are near the ring; notes which triangle of
  // it each is nearest to.
  bool staysNear(const Edge& edge) {
    const auto allowed = static_cast<double>(std::min(allowed_[edge.a], allowed_[edge.b]));
    const double enough = allowed * allowed;
    double nearest = std::numeric_limits<double>::infinity(), height = 0;
    bool smooth = true;
    // What failed once lies at the front and mostly fails again.
    for (const std::uint32_t t : star_) {
      const std::uint32_t i = firstSample_[t / 3];
      if (i == kNone) continue;
      if (nearestInRing(vectorOf(bounds_.samples[i].point)).second > enough) return false;
    }
    attached_.clear();
    for (const std::uint32_t t : star_) {
      std::uint32_t before = kNone;
      for (std::uint32_t i = firstSample_[t / 3]; i != kNone; before = i, i = nextSample_[i]) {
        const Vec3d at = vectorOf(bounds_.samples[i].point);
        const auto [triangle, squared] = nearestInRing(at);
        if (squared > enough) {
          if (before != kNone) {
            nextSample_[before] = nextSample_[i];
            attach(i, t);
          }
          return false;
        }
        attached_.emplace_back(i, ringTriangles_[triangle]);
        const Normal& n = bounds_.samples[i].normal;
        const Vec3d normal(n.x, n.y, n.z);
        smooth &= normal.dot(ring_[triangle].normal()) > kOneSide;
        const double apart = (at - edge.point).lengthSqr();
        if (apart >= nearest) continue;
        nearest = apart;
        height = std::abs(normal.dot(edge.point - at));
      }
    }
    return smooth ? height <= allowed : ringStaysNear(edge, allowed);
  }

  // The way back, from the ring to the surface: planes of samples tell nothing beside a crease.
  [[nodiscard]] bool ringStaysNear(const Edge& edge, double allowed) const {
    Vec3d sum(0.0);
    for (const FlatTriangle& triangle : ring_) sum += triangle.normal();
    sum.normalize();
    if (bounds_.distance(edge.point, sum) > allowed) return false;
    for (const FlatTriangle& triangle : ring_) {
      const Vec3d& p = triangle.corner(0);
      const Vec3d& x = triangle.corner(1);
      const Vec3d& y = triangle.corner(2);
      if (bounds_.distance((p + x + y) / 3.0, triangle.normal()) > allowed) return false;
      if (bounds_.distance((p + x) * 0.5, triangle.normal()) > allowed) return false;
    }
    return true;
  }

  bool canCollapse(const Edge& edge) {
    return keepsTopology(edge.a, edge.b) && collectRing(edge) && staysUnfolded() && staysNear(edge);
  }

  void apply(const Edge& edge) {
    const VertexIndex keep = edge.a, drop = edge.b;
    planes_[keep] = planes_[keep].seenFrom(edge.point - points_[keep]);
    planes_[keep] += planes_[drop].seenFrom(edge.point - points_[drop]);
    points_[keep] = edge.point;
    allowed_[keep] = std::min(allowed_[keep], allowed_[drop]);
    forTriangles(drop, [&](std::uint32_t t, VertexIndex x, VertexIndex y) {
      if (x != keep && y != keep) return;
      for (std::uint32_t i = 0; i < 3; ++i) corners_[t + i] = kNone;
      --alive_;
    });
    std::uint32_t last = kNone;
    for (std::uint32_t corner = first_[drop]; corner != kNone; corner = next_[corner]) {
      if (corners_[corner] == drop) corners_[corner] = keep;
      last = corner;
    }
    next_[last] = first_[keep];
    first_[keep] = first_[drop];
    dropDead(keep);
    vertexOf_[drop] = keep;
    for (const std::uint32_t t : star_) firstSample_[t / 3] = kNone;
    for (const auto& [sample, t] : attached_) attach(sample, t);
    ++version_[keep];
    ++version_[drop];
    collectNeighbours(keep, aroundA_);
    for (const VertexIndex vertex : aroundA_) propose(keep, vertex);
  }

  void dropDead(VertexIndex vertex) {
    std::uint32_t* link = &first_[vertex];
    while (*link != kNone) {
      if (corners_[*link] == vertex) {
        link = &next_[*link];
      } else {
        *link = next_[*link];
      }
    }
  }

  const Mesh& mesh_;
  std::vector<PlaneSum> planes_;
  const Bounds& bounds_;
  std::vector<float> allowed_;
  std::vector<Vec3d> points_;
  std::vector<std::uint32_t> ranks_;         // of each vertex by its place
  std::vector<VertexIndex> order_;           // the vertices by rank
  std::vector<VertexIndex> corners_;         // three for each triangle; kNone once it is gone
  std::vector<std::uint32_t> first_, next_;  // the corners at each vertex, as lists
  std::vector<std::uint32_t> version_;
  std::vector<VertexIndex> vertexOf_;  // what a vertex went into
  std::size_t alive_ = 0;
  std::vector<std::uint8_t> open_;  // vertices that a result before does not settle; empty: all
  EdgeQueue queue_;
  std::vector<VertexIndex> aroundA_, aroundB_, common_;
  std::vector<std::uint32_t> firstSample_, nextSample_;  // the samples of each triangle, as lists
  std::vector<std::uint32_t> sampleTriangles_;           // where each sample is
  // Of the edge at hand: the triangles around it, those that stay and what they become, and where
  // the samples go.
  std::vector<std::uint32_t> star_, ringTriangles_;
  std::vector<std::array<VertexIndex, 2>> ringEdges_;  // opposite to the new vertex
  std::vector<FlatTriangle> ring_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> attached_;
};

}  // namespace

Collapsed collapse(const Mesh& mesh, const std::vector<PlaneSum>& planes, const Bounds& bounds,
                   base::Job& job) {
  Collapser collapser(mesh, planes, bounds);
  collapser.run(job);
  return collapser.result();
}

}  // namespace tufa::simplify
