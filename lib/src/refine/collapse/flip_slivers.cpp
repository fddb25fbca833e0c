#include "refine/collapse/flip_slivers.h"

#include <algorithm>
#include <array>

#include "base/flat_triangle.h"
#include "refine/collapse/ring.h"

namespace tufa::refine {
namespace {

using base::FlatTriangle;

// An edge is flipped for a triangle less round than this, if the worse of the two becomes so many
// times rounder.
constexpr double kThin = 0.15;
constexpr double kBetter = 1.5;
// Least cosine between the normals of the new triangles and the mean normal of those they replace.
constexpr double kLeastTurn = 0.9;
// Least cosine to the normals of the triangles around, or this much less than the least one before.
constexpr double kFold = 0;
constexpr double kSharper = 0.02;
constexpr int kSweeps = 3;

class Turner {
 public:
  Turner(EdgeMesh& mesh, const Bounds& bounds, const std::vector<double>& budget,
         SampleLists samples)
      : mesh_(mesh),
        bounds_(bounds),
        budget_(budget),
        samples_(std::move(samples)),
        turned_(mesh.cornerCount() / 3, 0) {}

  bool sweep() {
    bool any = false;
    for (std::uint32_t t = 0; t < mesh_.cornerCount(); t += 3) {
      if (mesh_.isAlive(t) && turn(t)) any = true;
    }
    return any;
  }
  [[nodiscard]] std::vector<std::uint8_t> turned() && { return std::move(turned_); }

 private:
  // Two triangles at an edge from a to b: (a, b, c) and (b, a, d).
  struct Pair {
    std::uint32_t t, u;
    VertexIndex a, b, c, d;
  };

  [[nodiscard]] const Vec3& at(VertexIndex vertex) const { return mesh_.point(vertex); }
  [[nodiscard]] double roundnessOf(VertexIndex a, VertexIndex b, VertexIndex c) const {
    return roundness(at(a), at(b), at(c));
  }
  [[nodiscard]] Vec3 areaOf(VertexIndex a, VertexIndex b, VertexIndex c) const {
    return (at(b) - at(a)).cross(at(c) - at(a));
  }

  bool turn(std::uint32_t t) {
    const VertexIndex v[3] = {mesh_.corner(t), mesh_.corner(t + 1), mesh_.corner(t + 2)};
    if (roundnessOf(v[0], v[1], v[2]) >= kThin) return false;
    int longest = 0;
    double most = -1;
    for (int i = 0; i < 3; ++i) {
      const double length = (at(v[(i + 1) % 3]) - at(v[i])).squaredLength();
      if (length <= most) continue;
      most = length;
      longest = i;
    }
    Pair pair{t, kNone, v[longest], v[(longest + 1) % 3], v[(longest + 2) % 3], kNone};
    mesh_.forTriangles(pair.a, [&](std::uint32_t other, VertexIndex x, VertexIndex y) {
      if (y == pair.b) pair.u = other, pair.d = x;
    });
    if (pair.u == kNone || !mayFlip(pair) || !looksBetter(pair) || !staysNear(pair)) return false;
    mesh_.turn(pair.t, pair.u, pair.a, pair.b, pair.c, pair.d);
    moveSamples(pair);
    turned_[pair.t / 3] = turned_[pair.u / 3] = 1;
    return true;
  }

  // Topology: the four vertices are distinct, the new edge does not exist yet, and no vertex is
  // left with two triangles.
  [[nodiscard]] bool mayFlip(const Pair& pair) const {
    if (pair.c == pair.d || !(budgetAt(pair) > 0)) return false;
    bool joined = false;
    mesh_.forTriangles(pair.c, [&](std::uint32_t, VertexIndex x, VertexIndex y) {
      joined |= x == pair.d || y == pair.d;
    });
    return !joined && mesh_.degree(pair.a) > 3 && mesh_.degree(pair.b) > 3;
  }

  [[nodiscard]] double budgetAt(const Pair& pair) const {
    return std::min({budget_[pair.a], budget_[pair.b], budget_[pair.c], budget_[pair.d]});
  }

  // Shape: rounder, facing as the two triangles did, and no fold sharper than before at the four
  // outer edges.
  [[nodiscard]] bool looksBetter(const Pair& pair) const {
    const auto [t, u, a, b, c, d] = pair;
    const double before = std::min(roundnessOf(a, b, c), roundnessOf(b, a, d));
    const double after = std::min(roundnessOf(a, d, c), roundnessOf(b, c, d));
    if (after < kBetter * before) return false;
    Vec3 facing = areaOf(a, b, c) + areaOf(b, a, d), one = areaOf(a, d, c), two = areaOf(b, c, d);
    if (!facing.normalize() || !one.normalize() || !two.normalize()) return false;
    if (one.dot(facing) < kLeastTurn || two.dot(facing) < kLeastTurn) return false;
    double least = 1, was = 1;
    const auto look = [&](VertexIndex x, VertexIndex y, const Vec3& own) {
      const Vec3 across = Ring::normalAcross(mesh_, x, y, own);
      least = std::min(least, own.dot(across));
      was = std::min(was, facing.dot(across));
    };
    look(a, d, one);
    look(c, a, one);
    look(b, c, two);
    look(d, b, two);
    return least > std::min(kFold, was - kSharper);
  }

  // Distance: all samples on the two triangles, and the middle of the new edge from the surface.
  [[nodiscard]] bool staysNear(const Pair& pair) const {
    const double budget = budgetAt(pair);
    const std::array<FlatTriangle, 2> now = shapesOf(pair);
    for (const std::uint32_t t : {pair.t, pair.u}) {
      for (std::uint32_t i = samples_.front(t); i != kNone; i = samples_.after(i)) {
        if (nearest(now, i).second > budget * budget) return false;
      }
    }
    const Vec3 facing = now[0].normal() + now[1].normal();
    return bounds_.distance((at(pair.c) + at(pair.d)) * 0.5, facing, budget) <= budget;
  }

  [[nodiscard]] std::array<FlatTriangle, 2> shapesOf(const Pair& pair) const {
    return {FlatTriangle(at(pair.a), at(pair.d), at(pair.c)),
            FlatTriangle(at(pair.b), at(pair.c), at(pair.d))};
  }
  [[nodiscard]] std::pair<int, double> nearest(const std::array<FlatTriangle, 2>& shapes,
                                               std::uint32_t sample) const {
    const Position& p = bounds_.samples[sample].point;
    const double one = shapes[0].squaredDistance({p.x, p.y, p.z}),
                 two = shapes[1].squaredDistance({p.x, p.y, p.z});
    return two < one ? std::pair(1, two) : std::pair(0, one);
  }

  void moveSamples(const Pair& pair) {
    std::vector<std::uint32_t> samples;
    for (const std::uint32_t t : {pair.t, pair.u}) {
      for (std::uint32_t i = samples_.front(t); i != kNone; i = samples_.after(i)) {
        samples.push_back(i);
      }
      samples_.clear(t);
    }
    const std::array<FlatTriangle, 2> now = shapesOf(pair);
    for (const std::uint32_t i : samples) {
      samples_.attach(i, nearest(now, i).first == 0 ? pair.t : pair.u);
    }
  }

  EdgeMesh& mesh_;
  const Bounds& bounds_;
  const std::vector<double>& budget_;
  SampleLists samples_;
  std::vector<std::uint8_t> turned_;
};

}  // namespace

std::vector<std::uint8_t> flipSlivers(EdgeMesh& mesh, const Bounds& bounds,
                                      const std::vector<double>& budget, SampleLists samples) {
  Turner turner(mesh, bounds, budget, std::move(samples));
  for (int i = 0; i < kSweeps && turner.sweep(); ++i) {
  }
  return std::move(turner).turned();
}

}  // namespace tufa::refine
